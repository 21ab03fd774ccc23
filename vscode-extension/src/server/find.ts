// SPDX-License-Identifier: Apache-2.0
/**
 * Finds the server: in the user's setting, else in the active Python environment, else on PATH, else in the private
 * environment of the extension.
 *
 * - A setting that does not work is a failure: using another server instead would hide that.
 * - In an untrusted workspace, only the server of the private environment is started: settings, interpreters and PATH
 *   may refer to files of the workspace.
 */

import * as path from "node:path";
import type { Machine } from "./machine";
import { askPython } from "./python";
import type { PrivateEnvironment } from "./environment";
import type { Failure, Server } from "./server";

const PATIENCE = 20_000;

/** The minimum version of the server that this client supports. */
export const OLDEST_SERVER = "0.1.0";

export interface Wishes {
    /** `as2fm.server.path`; empty if not set. */
    readonly server: string;
    /** `as2fm.interpreter`; empty if not set. */
    readonly interpreter: string;
    /** The active interpreters of the extensions for Python. */
    readonly active: readonly string[];
    readonly trusted: boolean;
}

export async function findServer(
    machine: Machine,
    wishes: Wishes,
    environment: PrivateEnvironment,
): Promise<Server | Failure> {
    if (!wishes.trusted) return (await environment.server()) ?? { kind: "no-server" };
    if (wishes.server !== "") return configured(machine, wishes.server);
    const interpreters = wishes.interpreter !== "" ? [wishes.interpreter] : wishes.active;
    for (const interpreter of interpreters) {
        const server = await inPython(machine, interpreter);
        if (server !== undefined) return server;
    }
    return (await onPath(machine)) ?? (await environment.server()) ?? { kind: "no-server" };
}

/** The path in a setting, with `~` and `${workspaceFolder}` replaced by folders. */
export function expanded(written: string, home: string, workspace: string | undefined): string {
    const path = written.trim().replace(/^~(?=[/\\]|$)/, home);
    return workspace === undefined ? path : path.replaceAll("${workspaceFolder}", workspace);
}

/** Whether `version` is at least `oldest`; false for versions of another form. */
export function isRecent(version: string, oldest = OLDEST_SERVER): boolean {
    const numbers = (text: string) => text.split(/[^0-9]+/, 3).map(Number);
    const [found, wanted] = [numbers(version), numbers(oldest)];
    for (let i = 0; i < 3; i++) {
        const difference = (found[i] ?? 0) - (wanted[i] ?? 0);
        if (difference !== 0) return difference > 0;
    }
    return true;
}

async function configured(machine: Machine, file: string): Promise<Server | Failure> {
    const [version, said] = await askServer(machine, file);
    if (version === undefined) return { kind: "configured-server", path: file, detail: said };
    return { origin: "setting", command: file, args: [], version };
}

async function inPython(machine: Machine, interpreter: string): Promise<Server | undefined> {
    const python = await askPython(machine, interpreter);
    if (!python?.recent || python.server === undefined || !isRecent(python.server)) return undefined;
    return { origin: "python", command: interpreter, args: ["-I", "-m", "as2fm_lsp"], version: python.server };
}

async function onPath(machine: Machine): Promise<Server | undefined> {
    const file = await machine.which("as2fm-lsp");
    if (file === undefined || !path.isAbsolute(file)) return undefined;
    const [version] = await askServer(machine, file);
    if (version === undefined || !isRecent(version)) return undefined;
    return { origin: "path", command: file, args: [], version };
}

async function askServer(machine: Machine, file: string): Promise<[version: string | undefined, said: string]> {
    const ended = await machine.run(file, ["--version"], { timeout: PATIENCE });
    const version = ended.status === 0 ? /^as2fm-lsp (\S+)/.exec(ended.out)?.[1] : undefined;
    return [version, (ended.err || ended.out).trim()];
}
