// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { kernel, sample, type Stage } from "./support/stage";
import { INSTALLATION_TIMEOUT_MS } from "./support/window";

export function firstStart(stage: Stage): void {
    stage.use({}, { installs: false });

    stage.test("one click installs the server, and the error is shown", sample, async (window) => {
        await window.openFile("battery.ascxml");
        await window.notified("is not installed yet");
        await window.statusItem("AS2FM: not installed").waitFor();
        await window.screenshot("first-start");
        await window.acceptInstallation();
        await window.running(INSTALLATION_TIMEOUT_MS);
        await window.squiggles.first().waitFor();
        await window.becomes(() => window.squiggles.count(), 1);
        await window.run("View: Focus Problems");
        const problem = window.page.locator(".markers-panel .monaco-list-row", { hasText: "levle" });
        await problem.waitFor();
        assert.match((await problem.textContent()) ?? "", /there is no variable `levle`; did you mean `level`\?/);
        await problem.getByText("there is no variable").first().click();
        await window.statusItem(window.positionOf("nodes/battery.ascxml", '" expr="capacity"')).waitFor();
        await window.squiggles.first().waitFor();
        await window.screenshot("mistake");
    });

    stage.test("the next start installs nothing", sample, async (window) => {
        await window.openFile("battery.ascxml");
        await window.squiggles.first().waitFor();
        assert.equal(await window.page.locator(".notification-list-item").count(), 0);
        // The first start ended while the kernel of the model checker was being compiled.
        await kernel(stage.workbench.home);
    });
}
