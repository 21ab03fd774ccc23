// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { MEND, sample, SharedFolder, type Stage } from "./support/stage";
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
    const broken = new SharedFolder(sample);
    const mended = new SharedFolder(() => sample(MEND));

    stage.test(
        "translation writes a compact JANI file and opens it formatted, with its outline",
        mended,
        async (window) => {
            await window.openFile("tree.xml");
            await window.running();
            await window.run("AS2FM: Translate to JANI");
            await window.page.locator('.tab[data-resource-name="main (laid out).jani"]').waitFor();
            await window.notified("Wrote main.jani");
            const text = fs.readFileSync(path.join(window.folder, "main.jani"), "utf8");
            assert.ok((JSON.parse(text) as { automata: unknown[] }).automata.length > 5);
            assert.equal(text.trim().split("\n").length, 1);
            // The view is formatted and colored: keys and numbers have different colors.
            const line = window.page.locator(".view-line", { hasText: '"jani-version": 1' });
            await line.waitFor();
            const shades = () => line.locator("span span").count();
            await window.until(async () => (await shades()) > 3);
            const symbols = window.page.locator(".quick-input-list .monaco-list-row");
            const symbol = symbols.filter({ hasText: "topic_battery_msg.valid" });
            await window.repeat(() => window.run("Go to Symbol in Editor"), symbol);
            await window.screenshot("translate");
            await window.page.locator(".quick-input-widget input").first().fill("@never_empty");
            await symbols.and(window.page.locator('.focused[aria-label*="never_empty"]')).waitFor();
            await window.press("Enter");
            await window.until(async () => (await window.caretLine(1)).includes('"name": "never_empty"'));
        },
    );

    stage.test("plain SCXML beside its source follows the caret and edits", mended, async (window) => {
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
        // In the other direction, a click in the plain form moves to the source.
        await plain.locator(".view-line", { hasText: '<data id="docked"' }).click();
        await window.until(async () => (await window.caretLine(0)).includes('<data id="docked"'));
    });

    stage.test("a system with errors is not translated; the message leads to the error", broken, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Translate to JANI");
        await window.notified("main.xml has 1 error and was not translated.");
        await window.page.locator('.tab.active[data-resource-name="battery.ascxml"]').waitFor();
        await window.statusItem(`Ln ${window.placeIn("nodes/battery.ascxml", "levle")[0]}, Col`).waitFor();
        assert.ok(!fs.existsSync(path.join(window.folder, "main.jani")));
    });

    stage.test("the lens of a system with errors counts them and leads to the first one", broken, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        const lens = window.page.locator(".codelens-decoration a", {
            hasText: "1 error: cannot be translated or verified",
        });
        await lens.waitFor();
        assert.equal(await window.page.locator(".codelens-decoration a", { hasText: /^Translate/ }).count(), 0);
        await window.screenshot("lens-errors");
        const broken = window.page.locator('.tab.active[data-resource-name="battery.ascxml"]');
        await window.repeat(() => lens.click(), broken);
        const [line] = window.placeIn("nodes/battery.ascxml", "levle");
        await window.statusItem(`Ln ${line}, Col`).waitFor();
        await window.notified(`battery.ascxml:${line}: there is no variable`);
        await window.openFile("properties.jani");
        await window.page
            .locator(".codelens-decoration a", { hasText: "1 error in main.xml: cannot be verified" })
            .first()
            .click();
        await window.page.locator('.tab.active[data-resource-name="battery.ascxml"]').waitFor();
        // A verification opens the place of the error, too.
        await window.openFile("tree.xml");
        await window.run("AS2FM: Verify");
        await window.page.locator('.tab.active[data-resource-name="battery.ascxml"]').waitFor();
        // After the error is fixed, the lenses offer the translation again.
        await window.openFile("main.xml");
        const file = path.join(window.folder, "nodes/battery.ascxml");
        fs.writeFileSync(file, fs.readFileSync(file, "utf8").replace("levle", "level"));
        await window.page.locator(".codelens-decoration a", { hasText: "Translate to JANI" }).waitFor();
    });

    stage.test("the command Check Workspace runs a task and marks its findings", broken, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Check Workspace");
        await window.page.locator(".xterm-rows", { hasText: "9 files checked: 1 error" }).waitFor();
        await window.screenshot("task");
        // The editor and the task find the same problem, and it is shown once.
        await window.run("View: Focus Problems");
        const rows = window.page.locator(".markers-panel .monaco-list-row", { hasText: "there is no variable" });
        await rows.first().waitFor();
        await window.becomes(() => rows.count(), 1);
    });

    const configured = () => {
        const folder = sample(MEND);
        write(path.join(folder, "as2fm.toml"), 'ros-path = ["msgs"]\ningore = []\n');
        return folder;
    };
    stage.test(
        "errors in as2fm.toml are diagnostics that disappear after the correction",
        configured,
        async (window) => {
            await window.openFile("main.xml");
            await window.running();
            await window.openFile("as2fm.toml");
            await window.squiggles.first().waitFor();
            await window.page.locator(".squiggly-warning").first().waitFor();
            await window.run("View: Focus Problems");
            const problems = window.page.locator(".markers-panel");
            await problems.getByText("there is no setting `ingore`; did you mean `ignore`?").waitFor();
            await problems.getByText("there is no folder `msgs`").waitFor();
            await window.screenshot("configuration");
            assert.equal(await window.page.locator(".notification-list-item").count(), 0);
            await window.openFile("as2fm.toml");
            await window.goTo(2, 3);
            await window.quickFix("Change to `ignore`");
            await window.squiggles.first().waitFor({ state: "detached" });
            await window.goTo(1, 1);
            await window.press("Shift+End", "Delete");
            await window.page.locator(".squiggly-warning").first().waitFor({ state: "detached" });
            assert.equal(await window.page.locator(".notification-list-item").count(), 0);
        },
    );

    const unusual = () => {
        const folder = sample(MEND);
        const file = path.join(folder, "properties.jani");
        const operators = "∨ ∧ ¬ ⇒ ≠ ≤ ≥ ∀ ∃ π − ×";
        fs.writeFileSync(
            file,
            fs.readFileSync(file, "utf8").replace("{", `{ "x-operators": "${operators}", "x-nu": "ν",`),
        );
        return folder;
    };
    stage.test("operators of JANI are not marked as ambiguous characters", unusual, async (window) => {
        await window.openFile("properties.jani");
        await window.running();
        // VS Code marks the Greek letter, which looks like a Latin one. So it has checked the text.
        const boxes = window.page.locator(".view-overlays .unicode-highlight, .view-lines .unicode-highlight");
        await boxes.first().waitFor();
        await window.screenshot("unicode");
        await window.becomes(() => boxes.count(), 1);
    });

    stage.test("migration shows the changes and applies them", oldSystem, async (window) => {
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
