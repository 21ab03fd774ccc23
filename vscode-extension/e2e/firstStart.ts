// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { setTimeout as wait } from "node:timers/promises";
import * as fs from "node:fs";
import * as path from "node:path";
import { sample, type Stage } from "./support/stage";

/** Waits until the kernel has been compiled or its compilation has failed. */
async function kernelMark(home: string): Promise<void> {
    const environments = path.join(home, "data/data/User/globalStorage/as2fm-lsp.as2fm/environments");
    const isKnown = () =>
        fs.readdirSync(environments).some((name) => fs.existsSync(path.join(environments, name, "kernel.json")));
    const limit = Date.now() + 600_000;
    while (!isKnown()) {
        assert.ok(Date.now() < limit, "the kernel has not been compiled");
        await wait(200);
    }
}

export function firstStart(stage: Stage): void {
    stage.use();

    stage.test("one click installs the server, and the error is shown", sample, async (window) => {
        await window.openFile("battery.ascxml");
        const offer = window.notification("is not installed yet");
        await offer.waitFor();
        await window.statusItem("AS2FM: not installed").waitFor();
        await window.screenshot("first-start");
        await offer.getByRole("button", { name: "Install" }).click();
        await window.running();
        await window.squiggles.first().waitFor();
        assert.equal(await window.squiggles.count(), 1);
        await window.run("View: Focus Problems");
        const problem = window.page.locator(".markers-panel .monaco-list-row", { hasText: "levle" });
        await problem.waitFor();
        assert.match((await problem.textContent()) ?? "", /there is no variable `levle`; did you mean `level`\?/);
        await problem.getByText("there is no variable").first().click();
        await window.statusItem("Ln 28, Col 40").waitFor();
        await window.squiggles.first().waitFor();
        await window.screenshot("mistake");
    });

    stage.test("the next start installs nothing", sample, async (window) => {
        await window.openFile("battery.ascxml");
        await window.squiggles.first().waitFor();
        assert.equal(await window.page.locator(".notification-list-item").count(), 0);
        // The first start ended while the kernel of the model checker was being compiled.
        await kernelMark(stage.workbench.home);
    });
}
