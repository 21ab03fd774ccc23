// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { sample, type Stage } from "./support/stage";
import { write } from "./support/workbench";

/** A workspace that tries to have a program of its own started in place of the server. */
function hostile(): string {
    const folder = sample();
    const program = path.join(folder, "server.sh");
    write(program, `#!/bin/sh\ntouch ${folder}/started\necho as2fm-lsp 9.9.9\n`);
    fs.chmodSync(program, 0o755);
    write(path.join(folder, ".vscode/settings.json"), JSON.stringify({ "as2fm.server.path": program }));
    return folder;
}

export function restricted(stage: Stage): void {
    stage.use({ trustEverything: false });

    stage.test("models are checked, nothing of the workspace is started", hostile, async (window) => {
        await window.page.getByRole("button", { name: "No, I don't trust the authors" }).click();
        await window.openFile("battery.ascxml");
        await window.squiggles.first().waitFor();
        await window.statusItem("Restricted Mode").waitFor();
        assert.ok(!fs.existsSync(path.join(window.folder, "started")));
        const offered = await window.commands("AS2FM: ");
        const has = (title: string) => offered.some((each) => each.startsWith(`AS2FM: ${title}`));
        assert.ok(has("Show State Machine"));
        assert.ok(!has("Translate to JANI"));
        assert.ok(!has("Migrate"));
        assert.ok(!has("Check Workspace"));
        await window.screenshot("restricted");
    });

    stage.test("once trusted, the workspace decides", hostile, async (window) => {
        await window.page.getByRole("button", { name: "Yes, I trust the authors" }).click();
        await window.openFile("battery.ascxml");
        await window.until(() => fs.existsSync(path.join(window.folder, "started")));
        // It is no language server; that is said, with what to do.
        await window.notification("did not start").waitFor();
    });
}
