// SPDX-License-Identifier: Apache-2.0
import { constants } from "node:fs";
import * as fs from "node:fs/promises";
import * as path from "node:path";
import { run, type Ended, type RunOptions } from "./run";

/** The functions of the host that the search for a server needs. */
export interface Host {
    readonly windows: boolean;
    run(command: string, args: readonly string[], options?: RunOptions): Promise<Ended>;
    /** The absolute path of a program on PATH. */
    which(name: string): Promise<string | undefined>;
    /** The text of a file; undefined if it cannot be read. */
    read(file: string): Promise<string | undefined>;
    write(file: string, text: string): Promise<void>;
    remove(folder: string): Promise<void>;
    /** The names in a folder; none if the folder does not exist. */
    list(folder: string): Promise<readonly string[]>;
}

export const thisHost: Host = {
    windows: process.platform === "win32",
    run,
    async which(name) {
        const extensions = process.platform === "win32" ? [".exe"] : [""];
        for (const folder of (process.env["PATH"] ?? "").split(path.delimiter)) {
            // An empty or relative entry refers to the workspace, from which no program is started by its name.
            if (!path.isAbsolute(folder)) continue;
            for (const extension of extensions) {
                const file = path.join(folder, name + extension);
                if (await isExecutable(file)) return file;
            }
        }
        return undefined;
    },
    async read(file) {
        try {
            return await fs.readFile(file, "utf8");
        } catch {
            return undefined;
        }
    },
    async write(file, text) {
        await fs.mkdir(path.dirname(file), { recursive: true });
        await fs.writeFile(file, text);
    },
    async remove(folder) {
        await fs.rm(folder, { recursive: true, force: true });
    },
    async list(folder) {
        try {
            return await fs.readdir(folder);
        } catch {
            return [];
        }
    },
};

async function isExecutable(file: string): Promise<boolean> {
    try {
        await fs.access(file, constants.X_OK);
        return (await fs.stat(file)).isFile();
    } catch {
        return false;
    }
}
