// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { MEND, sample, SharedFolder, type Stage } from "./support/stage";

export function editing(stage: Stage): void {
    stage.use();
    const mended = new SharedFolder(() => sample(MEND));

    stage.test("a quick fix corrects the error", sample, async (window) => {
        await window.openFile("battery.ascxml");
        await window.squiggles.first().waitFor();
        await window.goBehind("nodes/battery.ascxml", 'location="levl');
        await window.quickFix("level", () => window.screenshot("quick-fix"));
        await window.squiggles.first().waitFor({ state: "detached" });
        await window.save();
        const file = path.join(window.folder, "nodes/battery.ascxml");
        await window.until(() => fs.readFileSync(file, "utf8").includes('location="level" expr="capacity"'));
    });

    stage.test("completion after _msg. lists the fields", mended, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        await window.goBehind("nodes/battery.ascxml", "_msg.data");
        await window.press(...Array.from(".data", () => "Backspace"));
        await window.type(".");
        const list = window.page.locator(".suggest-widget.visible");
        await list.locator('.monaco-list-row[aria-label^="data"]').waitFor();
        await window.screenshot("completion");
    });

    stage.test("completion after _msg. lists the fields at any typing speed", mended, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        const field = window.page.locator('.suggest-widget.visible .monaco-list-row[aria-label^="data"]');
        await window.goBehind("nodes/battery.ascxml", 'expr="_msg.data');
        for (const delay of [0, 50, 250]) {
            await window.press(...Array.from("_msg.data", () => "Backspace"), "Escape");
            for (const character of "_msg.") await window.page.keyboard.type(character, { delay });
            await field.waitFor();
            await window.screenshot("completion-typed");
            await window.press("Escape");
            await window.type("data");
            await window.press("Escape");
        }
    });

    stage.test("an accepted attribute opens the list of its values", mended, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        await window.goBehind("nodes/battery.ascxml", 'topic="/battery" type="std_msgs/UInt8"');
        await window.press(...Array.from(' type="std_msgs/UInt8"', () => "Backspace"), "Escape");
        await window.type(" ty");
        const list = window.page.locator(".suggest-widget.visible");
        await list.locator('.monaco-list-row.focused[aria-label^="type"]').waitFor();
        await window.press("Enter");
        await list.locator('.monaco-list-row[aria-label^="std_msgs/UInt8,"]').waitFor();
        await window.screenshot("attribute-values");
    });

    stage.test("hover shows the ROS definition", mended, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        await window.goBehind("nodes/battery.ascxml", "std_msgs/UI");
        const hover = window.page.locator(".monaco-hover:not(.hidden)", { hasText: "uint8 data" });
        await window.repeat(() => window.press("Control+K", "Control+I"), hover);
        await window.screenshot("hover");
    });

    stage.test("go to definition opens the plugin", mended, async (window) => {
        await window.openFile("tree.xml");
        await window.running();
        await window.goBehind("tree.xml", "<Deli");
        const definition = window.page.locator('.tab.active[data-resource-name="deliver.ascxml"]');
        await window.repeat(() => window.press("F12"), definition);
        await window.statusItem("Ln 3").waitFor();
        await window.screenshot("definition");
    });

    stage.test("a lens counts the uses of a symbol and shows them", mended, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        const lens = window.page.locator(".codelens-decoration a", { hasText: /^\d+ / }).first();
        await window.repeat(() => lens.click(), window.page.locator(".peekview-widget, .reference-zone-widget"));
        await window.screenshot("lens");
    });

    stage.test("rename changes both files", mended, async (window) => {
        await window.openFile("charge.ascxml");
        await window.running();
        await window.goBehind("plugins/charge.ascxml", 'topic="/do');
        const input = window.page.locator(".rename-box input");
        await window.repeat(() => window.press("F2"), input);
        await input.fill("/docking");
        await window.screenshot("rename");
        await window.press("Enter");
        await input.waitFor({ state: "hidden" });
        await window.run("File: Save All");
        const texts = ["plugins/charge.ascxml", "nodes/battery.ascxml"].map((file) => path.join(window.folder, file));
        await window.until(() => texts.every((file) => fs.readFileSync(file, "utf8").includes('topic="/docking"')));
    });

    stage.test("a node from the template has no errors", mended, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.runUntilAsked("AS2FM: New Node", "Name of the new node");
        await window.answer("Name of the new node");
        await window.page.locator('.tab.active[data-resource-name="my_node.ascxml"]').waitFor();
        const text = fs.readFileSync(path.join(window.folder, "nodes/my_node.ascxml"), "utf8");
        assert.match(text, /<ascxml name="MyNode"/);
        // A file that belongs to no system is checked by itself. Its outline shows that the server has read it.
        await window.runUntilAsked("Go to Symbol in Editor", "waiting");
        await window.becomes(() => window.squiggles.count(), 0);
    });
}
