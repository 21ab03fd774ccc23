// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { MEND, sample, type Stage } from "./support/stage";
import { write } from "./support/workbench";

/** A workspace that tries to run its own code: a program in place of the server, and modules with names that it imports. */
function hostile(change = {}): string {
    const folder = sample(change);
    for (const module of ["as2fm_lsp", "pip", "venv", "encodings"]) {
        const code = `open(${JSON.stringify(path.join(folder, "started"))}, "w").close()\n`;
        for (const name of ["__init__.py", "__main__.py"]) write(path.join(folder, module, name), code);
    }
    const program = path.join(folder, "server.sh");
    write(program, `#!/bin/sh\ntouch ${folder}/started\necho as2fm-lsp 9.9.9\n`);
    fs.chmodSync(program, 0o755);
    write(path.join(folder, ".vscode/settings.json"), JSON.stringify({ "as2fm.server.path": program }));
    return folder;
}

export function restricted(stage: Stage): void {
    stage.use({ trustEverything: false });

    stage.test("models are checked, and no program of the workspace is started", hostile, async (window) => {
        await window.page.getByRole("button", { name: "No, I don't trust the authors" }).click();
        await window.openFile("battery.ascxml");
        await window.squiggles.first().waitFor();
        await window.statusItem("Restricted Mode").waitFor();
        assert.ok(!fs.existsSync(path.join(window.folder, "started")));
        // The palette lists the commands for a machine after the server has classified the file.
        const offered = await window.until(async () => {
            const titles = await window.commands("AS2FM: ");
            return titles.some((title) => title.startsWith("AS2FM: Show State Machine")) ? titles : undefined;
        });
        const has = (title: string) => offered.some((action) => action.startsWith(`AS2FM: ${title}`));
        assert.ok(!has("Translate to JANI"));
        assert.ok(!has("Migrate"));
        assert.ok(!has("Check Workspace"));
        await window.screenshot("restricted");
    });

    stage.test(
        "lenses neither write files nor verify",
        () => hostile(MEND),
        async (window) => {
            await window.page.getByRole("button", { name: "No, I don't trust the authors" }).click();
            await window.openFile("main.xml");
            const before = content(window.folder);
            for (const lens of ["Translate to JANI", "Verify all"]) {
                const link = window.page.locator(".codelens-decoration a", { hasText: lens }).first();
                await window.repeat(() => link.click(), window.notification("This is disabled in Restricted Mode"));
                await window.run("Notifications: Clear All Notifications");
                await window.notification("This is disabled in Restricted Mode").first().waitFor({ state: "detached" });
            }
            assert.deepEqual(content(window.folder), before);
            await window.screenshot("restricted-lens");
        },
    );

    stage.test("a trusted workspace determines the server", hostile, async (window) => {
        await window.page.getByRole("button", { name: "Yes, I trust the authors" }).click();
        await window.openFile("battery.ascxml");
        await window.until(() => fs.existsSync(path.join(window.folder, "started")));
        // The program is not a language server. A message states this, and what to do.
        await window.notified("did not start: it ended with status 0");
    });
}

/** The files of a folder with their contents. */
function content(folder: string): Record<string, string> {
    const names = fs.readdirSync(folder, { recursive: true, encoding: "utf8" });
    const files = names.map((name) => path.join(folder, name)).filter((file) => fs.statSync(file).isFile());
    return Object.fromEntries(files.map((file) => [file, fs.readFileSync(file, "utf8")]));
}
