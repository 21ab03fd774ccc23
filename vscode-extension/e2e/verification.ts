// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import type { Locator } from "playwright-core";
import { MEND, sample, SharedFolder, type Stage } from "./support/stage";
import { themes } from "./support/themes";
import type { Window } from "./support/window";
import { ROOT } from "./support/paths";
import { temporaryFolder, write } from "./support/workbench";

export function verification(stage: Stage): void {
    stage.use();
    const mended = new SharedFolder(() => sample(MEND));

    stage.test("a sentence becomes a verified property", mended, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.runUntilAsked("AS2FM: New Property…", "A happens at some time");
        const choice = window.page.locator(".quick-input-widget .monaco-list-row");
        await window.screenshot("new-property");
        await choice.filter({ hasText: "A happens at some time" }).first().click();
        await choice.filter({ hasText: "a message is published on" }).first().click();
        await window.answer("within how many seconds");
        await lens(window, "Verify").first().waitFor();
        await window.until(() => fs.readFileSync(path.join(window.folder, "main.xml"), "utf8").includes('"xml"'));
        await lens(window, "Verify").last().click();
        await hint(window, "existence", "=\\s[01].*no\\sexpectation\\sset").waitFor();
    });

    stage.test("a lens verifies a property and shows the result", mended, async (window) => {
        await window.openFile("properties.jani");
        await window.running();
        await lens(window, "Verify").nth(1).click();
        await hint(window, "never_empty", "=\\s1,\\sexact,\\sno\\sexpectation\\sset").waitFor();
        await window.screenshot("verified");
    });

    for (const [look, theme] of themes("light", "light", "dark", "hc-light", "hc-dark")) {
        const themed = () => {
            // The battery is seldom empty before the last parcel.
            const folder = sample({ ...MEND, "tree.xml": (text) => text.replace('level="30"', 'level="0"') });
            write(path.join(folder, ".vscode/settings.json"), JSON.stringify({ "workbench.colorTheme": theme }));
            return folder;
        };
        stage.test(`pictures show the coverage of the last verification, ${look}`, themed, async (window) => {
            await window.openFile("main.xml");
            await window.running();
            await window.run("AS2FM: Show Behavior Tree");
            const tree = await window.picture();
            const coverage = tree.getByRole("button", { name: "Coverage" });
            await coverage.click();
            await tree.locator(".notice", { hasText: "No property has been verified" }).waitFor();
            await window.clickTab("main.xml");
            await lens(window, "Verify all").first().click();
            const charge = tree.locator('.node[data-label="Charge"]');
            await tree.locator('.node[data-cover="all"][data-label="Deliver"]').waitFor();
            assert.equal(await charge.getAttribute("data-cover"), "some");
            const words = /Charge, in \d+ of [\d,]+ traces, returned RUNNING in \d+ of [\d,]+ traces$/;
            assert.match((await charge.getAttribute("aria-label")) ?? "", words);
            await charge.locator(".cover-badge", { hasText: /^\d+ %$/ }).waitFor();
            await tree.locator(".legend", { hasText: /Coverage by the first .* traces of main\.xml/ }).waitFor();
            await window.screenshot(`coverage-tree-${look}`);
            await coverage.click();
            await tree.locator(".node:not([data-cover])[data-label='Charge']").waitFor();
            await window.page.locator(".tab", { hasText: "Behavior Tree" }).locator(".codicon-close").click();
            await window.openFile("deliver.ascxml");
            await window.run("AS2FM: Show State Machine");
            const machine = await window.picture();
            await machine.getByRole("button", { name: "Coverage" }).press("Enter");
            await machine.locator('.node[data-cover="all"]').first().waitFor();
            await window.becomes(() => machine.locator(".cover-badge", { hasText: "never" }).count(), 2);
            await window.screenshot(`coverage-machine-${look}`);
            // A picture that is drawn again keeps what is selected.
            const chosen = machine.locator("[data-edges].selected").first();
            await window.repeat(async () => {
                await machine.locator(".middle svg").first().press("ArrowDown");
                await machine.locator(".middle svg").first().press("t");
            }, chosen);
            await machine.getByRole("button", { name: "Coverage" }).press("Enter");
            await machine.locator(".cover-badge").first().waitFor({ state: "detached" });
            await chosen.waitFor({ state: "attached" });
        });
    }

    stage.test("the Test Explorer runs properties and shows their results", late, async (window) => {
        await window.openFile("properties.jani");
        await window.running();
        await explore(window);
        const [delivered, empty] = [row(window, "all_delivered"), row(window, "never_empty")];
        await delivered.hover();
        await delivered.getByRole("button", { name: "Run Test" }).click();
        // Nothing is expected of the property, so the test is neither green nor red.
        await icon(delivered, "skipped").waitFor();
        await delivered.filter({ hasText: /almost 1, exact, no expectation set/ }).waitFor();
        await icon(empty, "unset").waitFor();
        await window.run("Test: Run All Tests");
        await icon(empty, "failed").waitFor();
        await empty.filter({ hasText: /0, exact/ }).waitFor();
        await icon(row(window, "main.xml"), "failed").waitFor();
        // The message contains the expectation, and a link to a trace that contradicts it.
        await window.page.locator(".test-output-peek-tree .monaco-list-row", { hasText: "never_empty" }).click();
        await window.page.locator(".composite.panel", { hasText: /0, exact, expected ≥ 0\.9/ }).waitFor();
        const link = window.page.getByRole("link", { name: "Show Counterexample" });
        await link.waitFor();
        await window.screenshot("test-explorer");
        await link.click();
        await window.page.locator(".panel .message", { hasText: "never_empty failed in trace" }).waitFor();
        await selected(window).waitFor();
    });

    stage.test("a counterexample leads to its lines and is highlighted in diagrams", late, async (window) => {
        await window.openFile("tree.xml");
        await window.running();
        await button(window, "Show Behavior Tree").click();
        const tree = await window.picture();
        await window.openFile("properties.jani");
        await lens(window, "Verify").nth(1).click();
        // It opens at its end, with what has changed there; the turns lead to it.
        const heading = window.page.locator(".panel .message", { hasText: /; \d+ turns matter/ });
        await window.repeat(() => lens(window, "Show counterexample").click(), heading);
        await selected(window).last().waitFor();
        await window.screenshot("counterexample-end");
        // The last turn of the list is selected. Repeated turns are one line of it.
        const position = () => turnOf(window);
        const count = (await position()).of;
        assert.ok(count > 2);
        await window.becomes(position, { number: count, of: count });
        await state(window, "was").first().waitFor();
        const end = await selected(window).textContent();
        await window.page.locator(".panel").getByRole("button", { name: "Previous Step" }).click();
        await selected(window)
            .filter({ hasNotText: end ?? "" })
            .waitFor();
        await window.until(async () => (await position()).number === count - 1);
        await window.page.locator(".panel").getByRole("button", { name: "Next Step" }).click();
        await selected(window)
            .filter({ hasText: end ?? "" })
            .waitFor();
        await window.becomes(position, { number: count, of: count });
        await window.becomes(() => state(window, "__observer").count(), 0);
        // The list has only rows that are visible, so it is scrolled to its start.
        await selected(window).first().click();
        await window.press("Home");
        await step(window, "BatteryAbove: receives /battery").first().click();
        await state(window, "battery").filter({ hasText: "40  ← was 100" }).first().waitFor();
        await window.page.locator('.tab.active[data-resource-name="battery_above.ascxml"]').waitFor();
        await window.statusItem("Ln 18, Col 9").waitFor();
        await tree.locator('.node.highlighted[data-label="BatteryAbove"]').waitFor();
        await window.screenshot("counterexample");
        // The effects of the step are below it.
        await step(window, "battery: 100 → 40").waitFor();
        await window.page.locator(".panel").getByRole("button", { name: "Collapse All" }).click();
        await step(window, "ReactiveFallback: returns SUCCESS").first().click();
        await tree.locator('.node.highlighted[data-label="ReactiveFallback"]').waitFor();
        await window.page.locator('.tab.active[data-resource-name="tree.xml"]').waitFor();
        await window.becomes(() => tree.locator(".node.highlighted").count(), 1);
        // A picture that is opened later is highlighted as well.
        await window.page.locator(".tab", { hasText: "Behavior Tree: " }).locator(".codicon-close").click();
        await button(window, "Show Behavior Tree").click();
        await (await window.picture()).locator('.node.highlighted[data-label="ReactiveFallback"]').waitFor();
        // The machine that takes the step is drawn, with its state after the step.
        await window.openFile("building.ascxml");
        await button(window, "Show State Machine").click();
        const machine = await window.picture('.node[data-label="open"]');
        await step(window, "Battery: receives").first().click();
        await window.page.locator('.tab.active[data-resource-name="battery.ascxml"]').waitFor();
        await machine.locator('.node.highlighted[data-label="driving"]').waitFor();
        await window.screenshot("counterexample-machine");
    });

    stage.test("a result is stale while its system differs", late, async (window) => {
        await window.openFile("properties.jani");
        await window.running();
        await explore(window);
        await lens(window, "Verify").first().click();
        const [delivered, told] = [row(window, "all_delivered"), "=\\salmost\\s1,\\sexact,\\sno\\sexpectation\\sset"];
        await hint(window, "all_delivered", told).waitFor();
        await icon(delivered, "skipped").waitFor();
        await window.openFile("tree.xml");
        await window.goBehind("tree.xml", 'level="');
        await window.type("1");
        await icon(delivered, "skipped").and(window.page.locator(".retired")).waitFor();
        await window.openFile("properties.jani");
        await hint(window, "all_delivered", `${told},\\sstale`).waitFor();
        await window.screenshot("stale");
        await window.openFile("tree.xml");
        await window.press("Control+Z");
        await window.openFile("properties.jani");
        await hint(window, "all_delivered", `${told}(?!,\\sstale)`).waitFor();
    });

    stage.test("a failed property is reported once on its line", late, async (window) => {
        await window.openFile("properties.jani");
        await window.running();
        await lens(window, "Verify").nth(1).click();
        await hint(window, "never_empty", "✗\\s0,\\sexact,\\snot\\s≥\\s0\\.9").waitFor();
        await lens(window, "Show counterexample").waitFor();
        // At this time the test has failed. VS Code would have written its message behind the line.
        await window.page.locator(".testing-run-glyph.codicon-testing-failed-icon").first().waitFor();
        await window.screenshot("failed-property");
        const numbers = window.page.locator(".codelens-decoration a", { hasText: /\d/ });
        await window.becomes(() => numbers.count(), 0);
        // The line contains the expectation once.
        const content = window.editor.locator(".view-lines");
        await window.becomes(async () => (await content.textContent())?.split("0.9").length, 2);
    });

    stage.test("the command AS2FM: Verify runs all properties of the system and shows them", late, async (window) => {
        await window.openFile("tree.xml");
        await window.running();
        await window.run("AS2FM: Verify");
        await icon(row(window, "never_empty"), "failed").waitFor();
        await icon(row(window, "all_delivered"), "skipped").waitFor();

        // The nearest passing trace parts from a counterexample. Both sides lead to their lines, states, and stages.
        await window.openFile("properties.xml");
        await window.repeat(() => lens(window, "Show counterexample").last().click(), selected(window));
        await window.page.locator(".panel").getByRole("button", { name: "Where the Traces Part" }).click();
        await selected(window)
            .filter({ hasText: /^here: / })
            .waitFor();
        await step(window, /^trace \d+ passed: the first \d+ turns are the same/).waitFor();
        await state(window, /hand_over`\s*\{success: false/)
            .first()
            .waitFor();
        const there = step(window, /^there: /);
        await there.click();
        // The response is there what it was before, so its group is closed.
        const response = state(window, /hand_over`\s*\{success: true/);
        await window.repeat(async () => {
            await state(window, /^Messages/).click();
            await window.press("ArrowRight");
        }, response);
        await window.screenshot("parting");
        await there.hover();
        await there.getByRole("button", { name: "Show on Stage" }).click();
        const stage = await window.picture(".pane-timeline .drawing > svg");
        await stage.locator('body[data-step]:not([data-step="0"])').waitFor();
    });

    stage.test("a counterexample beside the nearest passing run, from where they part", dropping, async (window) => {
        await window.openFile("main_with_bug.xml");
        await window.running();
        await window.run("AS2FM: Verify");
        await window.openFile("properties.jani");
        await window.repeat(() => lens(window, "Show counterexample").first().click(), selected(window));
        await window.run("AS2FM: Compare with a Passing Run");
        const stage = await window.picture(".side.there .pane-timeline .drawing > svg");
        const [status, here, there] = [".compare-status", ".side.here", ".side.there"].map((part) =>
            stage.locator(part),
        ) as [Locator, Locator, Locator];
        await status.getByText("Here the runs part, at").waitFor();
        await stage.locator('.side.here[data-where="at"] .side-choice', { hasText: "/block/dropped" }).waitFor();
        await stage.locator('.side.there[data-where="at"]').waitFor(); // it follows the first run
        await window.becomes(() => stage.locator(".marked-line:visible").count(), 2);
        await window.becomes(() => stage.locator(".stage-grid").count(), 2);
        await window.screenshot("compare-at");
        const step = async (side: Locator) => Number(await side.getAttribute("data-step"));
        const [first, second] = [await step(here), await step(there)];
        const toolbar = stage.locator("body > .stage-bar");

        // One toolbar moves both. Before the runs part, they do the same; after it, the same time has passed.
        await toolbar.getByRole("button", { name: "Step Forward (.)" }).click();
        await status.getByText("The runs have parted").waitFor();
        await window.becomes(() => step(here), first + 1);
        await window.until(async () => (await step(there)) > second);
        await toolbar.getByRole("button", { name: "Go to the Start" }).click();
        await status.getByText("both runs do the same").waitFor();
        await window.becomes(async () => [await step(here), await step(there)], [0, 0]);
        await status.getByRole("button", { name: "Where the Runs Part" }).click();
        await window.becomes(async () => [await step(here), await step(there)], [first, second]);

        // The second run leads if the user goes to a step in its timeline.
        await there.locator(".rows").press("ArrowRight");
        await window.becomes(() => step(there), second + 1);
        await window.until(async () => (await step(here)) > first);
        await window.screenshot("compare-after");
    });

    stage.test("an expectation is set from a result and judges it at once", late, async (window) => {
        await window.openFile("properties.jani");
        await window.running();
        await explore(window);
        await lens(window, "Verify").first().click();
        const delivered = row(window, "all_delivered");
        await icon(delivered, "skipped").waitFor();
        const setExpectation = lens(window, "Set expectation");
        await window.repeat(() => setExpectation.click(), window.page.locator(".quick-input-title:visible"));
        await window.answer("all_delivered");
        await hint(window, "all_delivered", "✓\\salmost\\s1,\\sexact").waitFor();
        await icon(delivered, "passed").waitFor();
        await window.screenshot("expectation-set");
        await window.openFile("as2fm.toml");
        await window.page.locator(".view-line", { hasText: /all_delivered\s=\s">=\s0\.99"/ }).waitFor();
        // A click shows a witness.
        await window.openFile("properties.jani");
        await lens(window, "Show witness").first().click();
        await window.page.locator(".panel .message", { hasText: "all_delivered passed in trace" }).waitFor();
    });
}

/** A copy of the robot that drops the block. */
function dropping(): string {
    const folder = path.join(temporaryFolder("robot"), "assembly_robot");
    fs.cpSync(path.join(ROOT, "examples/assembly_robot"), folder, { recursive: true });
    return folder;
}

/** A robot that charges too late, after its battery is empty. */
function late(): string {
    const folder = sample({ ...MEND, "tree.xml": (text) => text.replace('level="30"', 'level="0"') });
    const verify = { "as2fm.verify.expectations": { never_empty: ">= 0.9" } };
    write(path.join(folder, ".vscode/settings.json"), JSON.stringify(verify));
    return folder;
}

function lens(window: Window, title: string): Locator {
    return window.page.locator(".codelens-decoration a", { hasText: new RegExp(`^${title}$`) });
}

/** The text after the name of a property, with the spaces that the editor draws. */
function hint(window: Window, property: string, text: string): Locator {
    return window.page.locator(".view-line", { hasText: new RegExp(`${property}.*${text}`) }).first();
}

/** A button above the editor, which appears when the server has reported the kind of the file. */
function button(window: Window, name: string): Locator {
    return window.page.locator(".editor-actions").getByRole("button", { name });
}

/** Show the properties of the system in the Test Explorer. */
async function explore(window: Window): Promise<void> {
    // VS Code requests no lenses while the focus is elsewhere.
    await lens(window, "Verify").first().waitFor();
    await window.run("Testing: Focus on Test Explorer View");
    await window.repeat(
        async () => {
            await row(window, "main.xml").click();
            await window.press("ArrowRight");
        },
        row(window, "never_empty"),
    );
}

/** A row of the Test Explorer. */
function row(window: Window, text: string | RegExp): Locator {
    return window.page.locator(".test-explorer-tree .monaco-list-row", { hasText: text });
}

function icon(row: Locator, state: "passed" | "failed" | "skipped" | "unset"): Locator {
    return row.locator(`.computed-state.codicon-testing-${state}-icon`);
}

/** A row of the counterexample. */
function step(window: Window, text: string | RegExp): Locator {
    return pane(window, "Counterexample").locator(".monaco-list-row", { hasText: text });
}

function selected(window: Window): Locator {
    return pane(window, "Counterexample").locator(".monaco-list-row.selected");
}

/** The number of the selected turn among all turns of the counterexample. */
async function turnOf(window: Window): Promise<{ number: number; of: number }> {
    const turn = pane(window, "Counterexample").locator('.monaco-list-row.selected[aria-level="1"]').first();
    const [number, of] = [await turn.getAttribute("aria-posinset"), await turn.getAttribute("aria-setsize")];
    return { number: Number(number), of: Number(of) };
}

/** A row of the state beside the counterexample. */
function state(window: Window, text: string | RegExp): Locator {
    return pane(window, "State").locator(".monaco-list-row", { hasText: text });
}

function pane(window: Window, name: string): Locator {
    return window.page.locator(".panel .pane", {
        has: window.page.locator(`.pane-header[aria-label^="${name}"]`),
    });
}
