// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import { VERSION } from "./support/paths";
import { sample, SharedFolder, type Stage } from "./support/stage";
import type { Window } from "./support/window";

export function serverLifeCycle(stage: Stage): void {
    stage.use();
    const broken = new SharedFolder(sample);

    stage.test("a killed server is restarted and reported", broken, async (window) => {
        await window.openFile("battery.ascxml");
        await window.squiggles.first().waitFor();
        const before = await onlyServer(window, stage.workbench.home);
        process.kill(before, "SIGKILL");
        await window.notified("ended unexpectedly and was restarted");
        await window.screenshot("restarted");
        assert.notEqual(await onlyServer(window, stage.workbench.home), before);
        // The new server has the open documents.
        await mend(window);
    });

    stage.test("the commands to restart the server and to show versions", broken, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        await window.squiggles.first().waitFor();
        await window.run("AS2FM: Show Versions");
        await window.notified(`as2fm-lsp ${VERSION}`);
        const before = await onlyServer(window, stage.workbench.home);
        await window.run("AS2FM: Restart Language Server");
        await window.until(() => servers(stage.workbench.home).some((pid) => pid !== before));
        await mend(window);
    });

    // Ended servers are counted, so this test needs a page of its own.
    stage.test("a server that crashes repeatedly is not restarted", sample, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        await onlyServer(window, stage.workbench.home);
        const killed = new Set<number>();
        while (killed.size < 4) {
            const next = () => servers(stage.workbench.home).find((pid) => !killed.has(pid));
            const pid = await window.until(next);
            process.kill(pid, "SIGKILL");
            killed.add(pid);
        }
        await window.statusItem("AS2FM: stopped").waitFor();
        await window.run("AS2FM: Restart Language Server");
        await window.squiggles.first().waitFor();
    });
}

/** Corrects the error in the editor; a running server then removes the squiggle. */
async function mend(window: Window): Promise<void> {
    await window.goBehind("nodes/battery.ascxml", 'location="levle');
    await window.press("Backspace", "Backspace");
    await window.type("el");
    await window.squiggles.first().waitFor({ state: "detached" });
}

/** The process id of the language server of a window, when that of the window before has ended. */
function onlyServer(window: Window, home: string): Promise<number> {
    return window.until(() => {
        const [server, ...others] = servers(home);
        return others.length === 0 ? server : undefined;
    });
}

/** The process ids of the language servers of this workbench's private environment. */
function servers(home: string): number[] {
    return fs.readdirSync("/proc").flatMap((name) => {
        try {
            const command = fs.readFileSync(`/proc/${name}/cmdline`, "utf8");
            return /^\d+$/.test(name) && command.startsWith(home) && command.includes("as2fm_lsp")
                ? [Number(name)]
                : [];
        } catch {
            return [];
        }
    });
}
