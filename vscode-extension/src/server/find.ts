// SPDX-License-Identifier: Apache-2.0
/**
 * Finds the server: in the user's setting, else in the active Python environment, else on PATH, else in the private
 * environment of the extension.
 *
 * - A setting that does not work is a failure. Another server would hide the problem.
 * - In an untrusted workspace, only the server of the private environment is started: settings, interpreters and PATH
 *   may refer to files of the workspace.
 */

import * as path from "node:path";
import type { Host } from "./host";
import { askPython } from "./python";
import type { PrivateEnvironment } from "./environment";
import type { Failure, Server } from "./server";

const TIMEOUT_MS = 20_000;

/** The minimum version of the server that this client supports. */
export const OLDEST_SERVER = "0.1.0";

export interface ServerSettings {
    /** `as2fm.server.path`; empty if not set. */
    readonly server: string;
    /** `as2fm.interpreter`; empty if not set. */
    readonly interpreter: string;
    /** The active interpreters of the extensions for Python. */
    readonly active: readonly string[];
    readonly trusted: boolean;
}

export async function findServer(
    host: Host,
    settings: ServerSettings,
    environment: PrivateEnvironment,
): Promise<Server | Failure> {
    if (!settings.trusted) return (await environment.server()) ?? { kind: "no-server" };
    if (settings.server !== "") return configured(host, settings.server);
    const interpreters = settings.interpreter !== "" ? [settings.interpreter] : settings.active;
    for (const interpreter of interpreters) {
        const server = await inPython(host, interpreter);
        if (server !== undefined) return server;
    }
    return (await onPath(host)) ?? (await environment.server()) ?? { kind: "no-server" };
}

/** The path in a setting, with `~` and `${workspaceFolder}` replaced by folders. */
export function expanded(written: string, home: string, workspace: string | undefined): string {
    const path = written.trim().replace(/^~(?=[/\\]|$)/, home);
    return workspace === undefined ? path : path.replaceAll("${workspaceFolder}", workspace);
}

/** Whether `version` is at least `oldest`; false for versions of another form. */
export function isRecent(version: string, oldest = OLDEST_SERVER): boolean {
    const numbers = (text: string) => text.split(/[^0-9]+/, 3).map(Number);
    const [actual, required] = [numbers(version), numbers(oldest)];
    for (let i = 0; i < 3; i++) {
        const difference = (actual[i] ?? 0) - (required[i] ?? 0);
        if (difference !== 0) return difference > 0;
    }
    return true;
}

async function configured(host: Host, file: string): Promise<Server | Failure> {
    const [version, said] = await askServer(host, file);
    if (version === undefined) return { kind: "configured-server", path: file, detail: said };
    return { origin: "setting", command: file, args: [], version };
}

async function inPython(host: Host, interpreter: string): Promise<Server | undefined> {
    const python = await askPython(host, interpreter);
    if (!python?.recent || python.server === undefined || !isRecent(python.server)) return undefined;
    return { origin: "python", command: interpreter, args: ["-I", "-m", "as2fm_lsp"], version: python.server };
}

async function onPath(host: Host): Promise<Server | undefined> {
    const file = await host.which("as2fm-lsp");
    if (file === undefined || !path.isAbsolute(file)) return undefined;
    const [version] = await askServer(host, file);
    if (version === undefined || !isRecent(version)) return undefined;
    return { origin: "path", command: file, args: [], version };
}

async function askServer(host: Host, file: string): Promise<[version: string | undefined, said: string]> {
    const ended = await host.run(file, ["--version"], { timeout: TIMEOUT_MS });
    const version = ended.status === 0 ? /^as2fm-lsp (\S+)/.exec(ended.out)?.[1] : undefined;
    return [version, (ended.err || ended.out).trim()];
}
