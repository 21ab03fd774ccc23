// SPDX-License-Identifier: Apache-2.0
/** An experiment, as a new user finds it: from the delivery robot to the plot that says which battery it needs. */

import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import type { Frame, Locator } from "playwright-core";
import { MEND, sample, type Stage } from "./support/stage";
import { themes } from "./support/themes";
import type { Window } from "./support/window";
import { write } from "./support/workbench";

const EXPERIMENT = "battery.experiment.toml";

export function experiments(stage: Stage): void {
    stage.use();

    for (const [look, theme] of themes("hc-dark", "light", "dark", "hc-light", "hc-dark")) {
        const robot = () => {
            const folder = sample(MEND);
            write(path.join(folder, ".vscode/settings.json"), JSON.stringify({ "workbench.colorTheme": theme }));
            return folder;
        };
        stage.test(
            `a number becomes a parameter, and a plot says which value is enough, ${look}`,
            robot,
            async (window) => {
                await window.openFile("main.xml");
                await window.running();
                await lens(window, "Experiment").first().click();
                // The comment about a number is shown with it.
                await choose(window, "Which number is varied?", "The charge of a full battery.");
                // The number is declared in the system file, and its proposed values can be changed.
                await window.answer("Values of initial_capacity (now 100)", "20:120:10");
                await window.question("Which properties are computed?").waitFor();
                await window.screenshot("experiment-properties");
                await pick(window, "all_delivered");
                await window.answer("Which value of all_delivered is enough?", ">= 0.99");
                const view = await page(window);
                const enough = "all_delivered ≥ 0.99 is met from initial_capacity = 40 on";
                await view.locator(".answers p", { hasText: enough }).waitFor();
                await view.locator(".status", { hasText: "11 points" }).waitFor();
                await view.locator(".point[data-key]").first().waitFor();
                await window.screenshot(`experiment-${look}`);
                // What is shown is saved, without computing it again.
                await view.getByRole("button", { name: "Save…" }).click();
                const table = path.join(window.folder, "main.csv");
                await window.saveAs(path.join(window.folder, "main.svg"), table);
                const text = fs.readFileSync(table, "utf8");
                const lines = text.trim().split("\n");
                assert.match(lines[1] ?? "", /^20,all_delivered,0\.0,/);
                assert.equal(lines.length, 12);
                await window.page.locator('.tab[data-resource-name="main.csv"] .codicon-close').first().click();
                // Another number is varied together with it, without leaving the questions.
                await lens(window, "Experiment").first().click();
                await window.question("Which parameters get several values?").waitFor();
                await pick(window, "Another number");
                await choose(window, "Which number is varied?", 'id="open" prob="0.8"');
                await window.question("Values of initial_capacity (now 100)").waitFor();
                await window.press("Escape");
                // A point leads to a run with its values.
                await view.locator('[data-key="all_delivered initial_capacity=20"]').first().click();
                await window.page.locator(".debug-toolbar").waitFor();
                await window.screenshot("experiment-run");
            },
        );
    }

    for (const [look, theme] of themes("light", "light", "dark")) {
        const empty = () => {
            const folder = parameterized({ "workbench.colorTheme": theme });
            write(path.join(folder, EXPERIMENT), "");
            return folder;
        };
        stage.test(`a file of an experiment is written with completion and runs, ${look}`, empty, async (window) => {
            await window.openFile(EXPERIMENT);
            await window.running();
            await complete(window, "mod", "model");
            await complete(window, "", "main.xml");
            await nextLine(window);
            await complete(window, "fin", "find");
            await window.screenshot(`file-find-${look}`);
            await complete(window, "", "charge");
            await nextLine(window);
            await complete(window, "mee", "meets");
            await complete(window, "all", "all_delivered >= 0.99");
            await nextLine(window);
            await complete(window, "se", "[set]");
            await window.screenshot(`file-set-${look}`);
            await complete(window, "", "charge");
            await window.screenshot(`file-written-${look}`);
            await lens(window, "Run the experiment").first().click();
            const view = await page(window);
            await view.locator(".answers p", { hasText: "all_delivered ≥ 0.99 is met from charge = 40 on" }).waitFor();
            await view.locator(".point[data-key]").first().waitFor();
            await window.screenshot(`file-plot-${look}`);
            // The lens runs it again in the same view. A mistake in the file is told there.
            write(path.join(window.folder, EXPERIMENT), "model = ");
            await lens(window, "Run the experiment").first().click();
            await view.locator(".status", { hasText: `${EXPERIMENT}:1:` }).waitFor();
            await window.becomes(() => window.page.locator(".tab", { hasText: "Experiment:" }).count(), 1);
            await window.screenshot(`file-mistake-${look}`);
        });
    }

    stage.test("an experiment in a file grows, is cancelled, and is run again", long, async (window) => {
        await window.openFile(EXPERIMENT);
        await window.running();
        await window.run("AS2FM: Experiment…");
        const view = await page(window);
        await view.locator(".status", { hasText: /^[1-9]\d* of 181 points$/ }).waitFor();
        await window.screenshot("experiment-grows");
        await view.getByRole("button", { name: "Cancel" }).click();
        await view.locator(".status", { hasText: /^Cancelled: \d+ of 181 points are known$/ }).waitFor();
        await view.locator(".points tbody tr").first().waitFor();
        write(path.join(window.folder, EXPERIMENT), file("100,nothing"));
        await view.getByRole("button", { name: "Run Again" }).click();
        await view.locator(".points td", { hasText: "unknown" }).waitFor();
    });
}

/** The sample, with an experiment that takes long enough to be cancelled. */
function long(): string {
    const folder = parameterized();
    write(path.join(folder, EXPERIMENT), file("20:200:1"));
    return folder;
}

/** The sample, with a parameter for the charge of its full battery. */
function parameterized(settings: Readonly<Record<string, unknown>> = {}): string {
    const folder = sample(MEND);
    write(path.join(folder, ".vscode/settings.json"), JSON.stringify(settings));
    const main = fs.readFileSync(path.join(folder, "main.xml"), "utf8");
    const declared = '<parameter name="charge" type="uint8" value="100" min="20" max="200" />';
    const section = `<parameter_declarations>${declared}</parameter_declarations>`;
    write(
        path.join(folder, "main.xml"),
        main.replace(/<roaml[^>]*>/, (root) => `${root}${section}`),
    );
    const battery = path.join(folder, "nodes/battery.ascxml");
    const text = fs.readFileSync(battery, "utf8");
    write(battery, text.replace('location="level" expr="capacity"', 'location="level" expr="charge"'));
    return folder;
}

function file(values: string): string {
    const lines = ['model = "main.xml"', 'property = ["all_delivered"]', 'method = "adaptive"', "epsilon = 0.005"];
    return [...lines, "", "[set]", `charge = "${values}"`, ""].join("\n");
}

function lens(window: Window, title: string): Locator {
    return window.page.locator(".codelens-decoration a", { hasText: title });
}

/** Chooses the entry of a list that contains a text. */
async function choose(window: Window, question: string, text: string): Promise<void> {
    await window.question(question).waitFor();
    await window.screenshot("experiment-number");
    await window.page.locator(".quick-input-widget .monaco-list-row", { hasText: text }).first().click();
}

/** Types the beginning of a word and accepts its completion. */
async function complete(window: Window, typed: string, name: string): Promise<void> {
    await window.type(typed);
    const row = window.page.locator(`.suggest-widget .monaco-list-row[aria-label^="${name}"]`).first();
    await window.repeat(() => window.press("Escape", "Control+Space"), row);
    await row.click();
    await window.page.locator(".suggest-widget .monaco-list-row").first().waitFor({ state: "hidden" });
}

/** Leaves the value that a completion has begun. */
async function nextLine(window: Window): Promise<void> {
    await window.press("End", "Enter");
}

/** Checks one entry of a list with several, and accepts it. */
async function pick(window: Window, name: string): Promise<void> {
    await window.page.locator(".quick-input-widget .monaco-list-row", { hasText: name }).first().click();
    await window.page.locator(".quick-input-widget").getByRole("button", { name: "OK" }).click();
}

/** The page of the experiment. */
async function page(window: Window): Promise<Frame> {
    return window.picture(".experiment");
}
