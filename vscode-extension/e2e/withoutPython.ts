// SPDX-License-Identifier: Apache-2.0
import * as fs from "node:fs";
import * as path from "node:path";
import { test } from "node:test";
import { sample } from "./support/stage";
import { INSTALLATION_TIMEOUT_MS } from "./support/window";
import { temporaryFolder, Workbench, write } from "./support/workbench";

export function withoutPython(): void {
    test("without Python, the message states how to install it", async () => {
        await install({ PATH: programs("sh", "cat", "uname", "env") }, async (said) => {
            await said("needs Python 3.10 or newer", "no-python");
        });
    });

    test("without a package index, the message states what to do", async () => {
        const nowhere = {
            PIP_INDEX_URL: "http://127.0.0.1:9/simple",
            PIP_RETRIES: "0",
            PIP_CONFIG_FILE: "/dev/null",
            NO_PROXY: "*",
        };
        await install(nowhere, async (said) => {
            await said("pip could not download the packages", "no-index");
        });
    });

    test("without venv, the message names the package to install", async () => {
        const folder = programs("sh", "cat", "uname", "env");
        // The interpreter only reports its own properties.
        const script = ["#!/bin/sh", 'case "$*" in', '*" venv "*) echo "ensurepip is not available" >&2; exit 1 ;;'];
        script.push('*) echo "$0"; echo 3; echo 11 ;;', "esac", "");
        write(path.join(folder, "python3"), script.join("\n"));
        fs.chmodSync(path.join(folder, "python3"), 0o755);
        await install({ PATH: folder }, async (said) => {
            await said("apt install python3-venv", "no-venv");
        });
    });
}

async function install(
    environment: Record<string, string>,
    check: (said: (text: string, name: string) => Promise<void>) => Promise<void>,
): Promise<void> {
    const workbench = await Workbench.start({ environment });
    try {
        const window = await workbench.open(sample());
        await window.openFile("battery.ascxml");
        await window.acceptInstallation();
        await check(async (text, name) => {
            await window.notified(text, INSTALLATION_TIMEOUT_MS);
            await window.screenshot(name);
        });
    } finally {
        await workbench.stop();
    }
}

/** A folder for PATH that contains only the given programs. */
function programs(...names: string[]): string {
    const folder = temporaryFolder("path");
    for (const name of names) {
        const program = ["/bin", "/usr/bin"]
            .map((directory) => path.join(directory, name))
            .find((file) => fs.existsSync(file));
        if (program !== undefined) fs.symlinkSync(program, path.join(folder, name));
    }
    return folder;
}
