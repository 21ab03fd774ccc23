// SPDX-License-Identifier: Apache-2.0
import * as fs from "node:fs";
import * as path from "node:path";
import type { Stage } from "./support/stage";
import { temporaryFolder, write } from "./support/workbench";

const ROBOT = path.resolve("..", "examples", "assembly_robot");

/** A copy of the robot that drops the block. The configuration leaves the system to the active file. */
function robot(): string {
    const folder = temporaryFolder("robot");
    fs.cpSync(ROBOT, folder, { recursive: true });
    const name = "Debug Counterexample";
    const configuration = { type: "as2fm", request: "launch", name, property: "never_placed_empty", against: 1 };
    write(
        path.join(folder, ".vscode/launch.json"),
        JSON.stringify({ version: "0.2.0", configurations: [configuration] }),
    );
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
        const stack = page.locator(".debug-call-stack");
        const choices = page.locator(".pane", { hasText: "Choices" });
        // The run stops where the arm is about to drop the block.
        await page.keyboard.press("F5");
        await stack.getByText("the tick of its timer `step`").first().waitFor({ timeout: PATIENCE });
        await page.locator('.tab.active[data-resource-name="arm.ascxml"]').waitFor();
        await window.screenshot("debugging");
        // A step further it is dropped; a step back it is not.
        await page.keyboard.press("F11");
        await stack.getByText("<ros_topic_publish>").first().waitFor();
        await window.run("Debug: Step Back");
        await stack.getByText("the tick of its timer `step`").first().waitFor();
        await choices.getByText("way := 2, Arm enters").first().click();
        await choices.getByText("chosen by hand").first().waitFor();
        await stack.getByText("the tick of its timer `step`").first().waitFor({ state: "detached" });
        await window.screenshot("debugging-choice");
        await window.run("Debug: Stop");
        await stack.waitFor({ state: "detached" });
    });
}

const PATIENCE = 300_000;
