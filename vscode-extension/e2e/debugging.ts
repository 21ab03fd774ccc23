// SPDX-License-Identifier: Apache-2.0
import * as fs from "node:fs";
import * as path from "node:path";
import type { Stage } from "./support/stage";
import type { Window } from "./support/window";
import { ROOT } from "./support/paths";
import { temporaryFolder, write } from "./support/workbench";

const PROPERTY = "never_placed_empty";

/** A copy of the robot that drops the block. The configuration leaves the system to the active file. */
function robot(): string {
    const folder = temporaryFolder("robot");
    fs.cpSync(path.join(ROOT, "examples/assembly_robot"), folder, { recursive: true });
    const name = "Debug Counterexample";
    const configuration = { type: "as2fm", request: "launch", name, property: PROPERTY, against: 1 };
    const configurations = { version: "0.2.0", configurations: [configuration] };
    write(path.join(folder, ".vscode/launch.json"), JSON.stringify(configurations));
    return folder;
}

export function debugging(stage: Stage): void {
    stage.use();

    stage.test("F5 goes to the dropped block, and back to where chance decides otherwise", robot, async (window) => {
        const { page } = window;
        await window.openFile("arm.ascxml");
        await window.running();
        await window.goBehind("arm.ascxml", '<target id="moving">');
        await page.keyboard.press("F9");
        await page.locator(".codicon-debug-breakpoint, .codicon-debug-breakpoint-unverified").first().waitFor();
        await window.openFile("main_with_bug.xml");
        await page.keyboard.press("F5");
        const frame = page
            .locator(".debug-call-stack .monaco-list-row", { hasText: "Arm: <target> by chance" })
            .first();
        const choices = page.locator(".pane").filter({ has: page.locator('.pane-header[aria-label^="Choices"]') });

        // A low window has no space for all views.
        await page.locator('.pane-header[aria-label^="Watch"][aria-expanded="true"]').click();
        await page.locator('.pane-header[aria-label^="Breakpoints"][aria-expanded="true"]').click();

        // The run stops before the arm drops the block.
        await frame.waitFor();
        await page.locator('.tab.active[data-resource-name="arm.ascxml"]').waitFor();
        await window.editor
            .locator(".view-line", { hasText: /holding\s=\strue/ })
            .first()
            .waitFor();
        await choices.getByText("is not decided yet").waitFor();
        await choices.locator(".monaco-list-row", { hasText: "way := 2, Arm enters" }).first().waitFor();
        await window.screenshot("debugging");

        // After a turn it is dropped. Backwards, the run stops where chance decides.
        await button(window, "Step Over").click();
        await frame.waitFor({ state: "detached" });
        await button(window, "Reverse").click();
        await frame.waitFor();

        // The arm keeps the block, and the property holds to the end.
        await choices.getByText("way := 2, Arm enters").first().click();
        await choices.getByText("chosen by the user").first().waitFor();
        await page.keyboard.press("F5");
        await choices.getByText(`The property ${PROPERTY} holds in this run.`).waitFor();
        await page.locator(".debug-call-stack").getByText("Paused on exception").first().waitFor();
        await choices.locator(".monaco-list-row").first().waitFor({ state: "detached" });
        await window.screenshot("debugging-choice");
        await button(window, "Stop").click();
        await page.locator(".debug-toolbar").waitFor({ state: "hidden" });
    });
}

function button(window: Window, name: string) {
    return window.page.locator(`.debug-toolbar .action-label[aria-label^="${name}"]`);
}
