// SPDX-License-Identifier: Apache-2.0
/** Longer ways of a user: with the keyboard alone, with several editors and folders, while files change on the disk. */

import * as fs from "node:fs";
import * as path from "node:path";
import type { Frame, Locator } from "playwright-core";
import { MEND, sample, SharedFolder, type Stage } from "./support/stage";
import { themes } from "./support/themes";
import type { Window } from "./support/window";
import { temporaryFolder, write } from "./support/workbench";

const BATTERY = "nodes/battery.ascxml";

export function journeys(stage: Stage): void {
    stage.use();
    const mended = new SharedFolder(() => sample(MEND));

    for (const [look, theme] of themes("light", "light", "dark", "hc-dark")) {
        const failing = () => late({ "workbench.colorTheme": theme });
        stage.test(`from a failed property to its line with the keyboard alone, ${look}`, failing, async (window) => {
            const { page } = window;
            await window.openFile("tree.xml");
            await window.running();
            await verified(window);
            await window.runUntilAsked("AS2FM: Show Counterexample", "Which property?");
            await window.answer("Which property?"); // the first one is that which fails
            await page.locator(".part.panel .pane-header", { hasText: "never_empty" }).waitFor();
            await page.locator('.tab.active[data-resource-name="battery.ascxml"]').waitFor();
            await window.repeat(() => window.press("Control+1"), window.focusedEditor);
            await window.statusItem(window.positionOf(BATTERY, "<ros_rate_callback")).waitFor();

            // The picture receives the focus, and says which node its keys have selected.
            await window.run("AS2FM: Show State Machine");
            const picture = await window.picture('[data-label="charging"]');
            const focused = picture.locator("svg.picture:focus");
            await window.repeat(() => window.press("Control+2"), focused);
            await window.repeat(() => window.press("ArrowDown"), focused.and(selecting(picture)));
            await window.becomes(() => spoken(picture), "state, driving");
            await window.press("t");
            await window.until(async () => (await spoken(picture)).startsWith("driving → "));
            await window.press("ArrowDown");
            await window.becomes(() => spoken(picture), "state, charging");
            await window.screenshot(`keyboard-${look}`);
            await window.press("Enter");
            await window.focusedEditor.waitFor();
            await window.statusItem(window.positionOf(BATTERY, '<state id="charging"')).waitFor();
        });
    }

    stage.test("a change in a picture is undone there, in the editor that was used last", mended, async (window) => {
        const { page } = window;
        await window.openFile("battery.ascxml");
        await window.running();
        await window.run("AS2FM: Show State Machine");
        const picture = await window.picture('[data-label="charging"]');
        const state = (name: string) => picture.locator(`.node[data-label="${name}"]`);
        await state("charging").click();
        await window.focusedEditor.waitFor();
        await state("charging").click({ button: "right" });
        const rename = page.locator(".monaco-menu .action-item", { hasText: "Rename…" });
        await window.repeat(() => rename.click(), window.question("The new name of"));
        await window.answer("The new name of", "docking");
        await state("docking").waitFor();
        await window.repeat(() => picture.locator("svg.picture").press("Control+z"), state("charging"));
        await picture.locator("svg.picture:focus").waitFor();
        await window.repeat(() => picture.locator("svg.picture").press("Control+Shift+Z"), state("docking"));
        await window.repeat(() => picture.locator("svg.picture").press("Control+z"), state("charging"));

        // A second editor of the file, which was used last, shows the place of a node.
        const groups = page.locator(".editor-group-container");
        await window.clickTab("battery.ascxml");
        await window.press("Control+Backslash");
        await window.becomes(() => groups.count(), 3);
        await window.goTo(1);
        await state("driving").click();
        await groups.nth(1).and(page.locator(".active")).waitFor();
        await window.statusItem(window.positionOf(BATTERY, '<state id="driving"')).waitFor();
    });

    stage.test("a picture follows a file without an editor that other programs change", mended, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        await window.run("AS2FM: Show State Machine");
        const picture = await window.picture('[data-label="charging"]');
        await window.page.locator('.tab[data-resource-name="battery.ascxml"] .codicon-close').click();
        const state = (name: string) => picture.locator(`.node[data-label="${name}"]`);
        const file = path.join(window.folder, BATTERY);
        const text = fs.readFileSync(file, "utf8");
        fs.writeFileSync(file, text.replaceAll('"charging"', '"docking"'));
        await state("docking").waitFor();
        fs.renameSync(file, path.join(window.folder, "nodes/accu.ascxml"));
        await picture.getByText("nodes/battery.ascxml does not exist any more.").waitFor();
        fs.writeFileSync(file, text);
        await state("charging").waitFor();
    });

    stage.test(
        "after a cancelled verification, the results that are known are stale, not new",
        late,
        async (window) => {
            const { page } = window;
            await window.openFile("tree.xml");
            await window.running();
            await verified(window);
            settings(window.folder, { exactIfSmall: false, epsilon: 1e-6, confidence: 0.9999 });
            await window.run("Properties: Focus on Properties View");
            await window.openFile("tree.xml");
            await window.goBehind("tree.xml", 'level="');
            await window.type("1");
            const failed = test(window, "never_empty");
            await failed.filter({ hasText: "0, exact, stale" }).waitFor();
            await window.run("AS2FM: Verify");
            const row = page.locator(".part.panel .monaco-list-row", { hasText: "never_empty" });
            await row.filter({ hasText: "Verifying…" }).waitFor();
            await window.screenshot("verifying");
            const cancel = page.locator('.part.sidebar .action-label[aria-label^="Cancel Test Run"]').first();
            await window.repeat(() => cancel.click(), row.filter({ hasText: "not ≥ 0.9, stale" }));
            await failed.filter({ hasText: "0, exact, stale" }).locator(".retired").waitFor();
            await window.clickTab("tree.xml");
            await window.press("Control+Z");
            await failed.locator(".codicon-testing-failed-icon:not(.retired)").waitFor();
        },
    );

    stage.test(
        "systems of several folders are told apart, also after a folder is removed",
        twoFolders,
        async (window) => {
            const { page } = window;
            await window.openFile("two.xml");
            await window.running();
            await window.page.locator(".codelens-decoration a", { hasText: "Verify" }).first().waitFor();
            await window.run("Properties: Focus on Properties View");
            const systems = page.locator('.part.panel .monaco-list-row[aria-level="1"]');
            await window.becomes(() => systems.allTextContents(), ["one/main.xml", "two/main.xml"]);
            await window.run("View: Close All Editors");
            write(path.join(window.folder, "both.code-workspace"), JSON.stringify({ folders: [{ path: "one" }] }));
            await window.becomes(() => systems.allTextContents(), ["main.xml"]);
        },
    );
}

/** A robot that charges too late, after its battery is empty. */
function late(further: Readonly<Record<string, unknown>> = {}): string {
    const folder = sample({ ...MEND, "tree.xml": (text) => text.replace('level="30"', 'level="0"') });
    const expectations = { never_empty: ">= 0.9" };
    write(
        path.join(folder, ".vscode/settings.json"),
        JSON.stringify({ "as2fm.verify.expectations": expectations, ...further }),
    );
    return folder;
}

/** Change settings of the verification in a folder. */
function settings(folder: string, changed: Readonly<Record<string, unknown>>): void {
    const file = path.join(folder, ".vscode/settings.json");
    const before = JSON.parse(fs.readFileSync(file, "utf8")) as object;
    const now = Object.fromEntries(Object.entries(changed).map(([name, value]) => [`as2fm.verify.${name}`, value]));
    fs.writeFileSync(file, JSON.stringify({ ...before, ...now }));
}

/** A workspace with two folders, whose systems have files of the same names. */
function twoFolders(): string {
    const folder = temporaryFolder("folders");
    for (const name of ["one", "two"]) fs.cpSync(sample(MEND), path.join(folder, name), { recursive: true });
    fs.renameSync(path.join(folder, "two/tree.xml"), path.join(folder, "two/two.xml"));
    const main = path.join(folder, "two/main.xml");
    fs.writeFileSync(main, fs.readFileSync(main, "utf8").replace("tree.xml", "two.xml"));
    const file = path.join(folder, "both.code-workspace");
    write(file, JSON.stringify({ folders: [{ path: "one" }, { path: "two" }] }));
    return file;
}

/** Verify the system until the property that fails has its result. */
async function verified(window: Window): Promise<void> {
    await window.run("AS2FM: Verify");
    await test(window, "never_empty").locator(".codicon-testing-failed-icon").waitFor();
}

/** A row of the Test Explorer. */
function test(window: Window, name: string): Locator {
    return window.page.locator(".test-explorer-tree .monaco-list-row", { hasText: name });
}

/** The picture, if it says which part is selected. */
function selecting(picture: Frame): Locator {
    return picture.locator("svg.picture[aria-activedescendant]");
}

/** The name of the part that a screen reader reads. */
async function spoken(picture: Frame): Promise<string> {
    const id = await selecting(picture).getAttribute("aria-activedescendant");
    return (await picture.locator(`[id="${id}"]`).getAttribute("aria-label")) ?? "";
}
