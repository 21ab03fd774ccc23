// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { MEND, sample, type Stage } from "./support/stage";
import { temporaryFolder, write } from "./support/workbench";

const OLD_SYSTEM = `<convince_mc_tc>
    <mc_parameters><max_time value="10" unit="s" /></mc_parameters>
    <node_models><input type="ros-scxml" src="clock.scxml" /></node_models>
</convince_mc_tc>
`;
const OLD_MACHINE = `<scxml name="Clock" version="1.0" initial="on">
    <ros_time_rate name="second" rate_hz="1" />
    <state id="on"><ros_rate_callback name="second" target="on" /></state>
</scxml>
`;

export function systems(stage: Stage): void {
    stage.use();

    stage.test(
        "translate writes the JANI file and opens it",
        () => sample(MEND),
        async (window) => {
            await window.openFile("tree.xml");
            await window.running();
            await window.run("AS2FM: Translate to JANI");
            await window.page.locator('.tab[data-resource-name="main.jani"]').waitFor();
            await window.notification("Wrote main.jani").waitFor();
            await window.screenshot("translate");
            const model = JSON.parse(fs.readFileSync(path.join(window.folder, "main.jani"), "utf8")) as {
                automata: unknown[];
            };
            assert.ok(model.automata.length > 5);
        },
    );

    stage.test("a system with errors is not translated, and says why", sample, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Translate to JANI");
        await window.notification("main.xml has 1 error and was not translated.").waitFor();
        assert.ok(!fs.existsSync(path.join(window.folder, "main.jani")));
    });

    stage.test(
        "plain SCXML beside its source follows the caret and the edits",
        () => sample(MEND),
        async (window) => {
            await window.openFile("battery.ascxml");
            await window.running();
            await window.run("AS2FM: Show Plain SCXML");
            await window.page.locator('.tab[data-resource-name="battery (plain).scxml"]').waitFor();
            const plain = window.page.locator(".editor-group-container").nth(1);
            await plain.locator(".view-line", { hasText: "Math.max" }).waitFor();
            await window.goBehind("nodes/battery.ascxml", 'location="docked');
            await plain.locator(".view-line", { hasText: "docked" }).first().waitFor();
            await window.screenshot("plain");
            await window.goBehind("nodes/battery.ascxml", "Math.max(level - 1");
            await window.type("5");
            await plain.locator(".view-line", { hasText: "Math.max(level - 150, 0)" }).waitFor();
            // The other way round: a click in the plain form goes to the source.
            await plain.locator(".view-line", { hasText: '<data id="docked"' }).click();
            await window.until(async () => (await window.caretLine(0)).includes('<data id="docked"'));
        },
    );

    stage.test("check workspace is a task that marks what it finds", sample, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Check Workspace");
        await window.page.locator(".xterm-rows", { hasText: "8 files checked: 1 error" }).waitFor();
        await window.screenshot("task");
        // Editor and task find the same, and it is shown once.
        await window.run("View: Focus Problems");
        const rows = window.page.locator(".markers-panel .monaco-list-row", { hasText: "there is no variable" });
        await rows.first().waitFor();
        assert.equal(await rows.count(), 1);
    });

    stage.test("migrating shows what would change, and changes it", oldSystem, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Migrate System");
        const apply = window.page.locator(".monaco-dialog-box").getByRole("button", { name: "Migrate", exact: true });
        await apply.waitFor();
        await window.page.locator(".monaco-dialog-box", { hasText: "clock.scxml → clock.ascxml" }).waitFor();
        await window.screenshot("migrate");
        assert.ok(fs.existsSync(path.join(window.folder, "clock.scxml")));
        await apply.click();
        await window.until(() => fs.existsSync(path.join(window.folder, "clock.ascxml")));
        await window.until(() => fs.readFileSync(path.join(window.folder, "main.xml"), "utf8").startsWith("<roaml>"));
        assert.ok(!fs.existsSync(path.join(window.folder, "clock.scxml")));
    });
}

function oldSystem(): string {
    const folder = temporaryFolder("old");
    write(path.join(folder, "main.xml"), OLD_SYSTEM);
    write(path.join(folder, "clock.scxml"), OLD_MACHINE);
    return folder;
}
