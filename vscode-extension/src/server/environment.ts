// SPDX-License-Identifier: Apache-2.0
/**
 * The private Python environment of the extension, with the server from the wheel in the extension.
 *
 * - An environment is named after its wheel, so a new version of the extension creates a new one and removes the old
 *   one.
 * - It is valid only if it has a mark file, which is written as the last step: an interrupted installation is repeated.
 * - An extension for one platform contains the packages that the server needs, so that no network is necessary.
 *   Otherwise, and for a Python for which it contains none, they come from the index for which the user's pip is
 *   configured. Only files with known hashes are installed, and none of them runs code during its installation.
 */

import * as path from "node:path";
import type { Host } from "./host";
import { pythons, type Python } from "./python";
import type { Ended } from "./run";
import type { Failure, Server } from "./server";

const MARK = "ready.json";
/** The file that records whether the kernel of the model checker can be compiled here. */
const KERNEL_MARK = "kernel.json";
/** The exit status of `build_kernel` if the kernel cannot be compiled here. */
const CANNOT_COMPILE = 1;

/** The progress that is shown to the user. */
export type Step = "python" | "venv" | "packages";

export interface InstallOptions {
    readonly signal?: AbortSignal;
    readonly onStep?: (step: Step) => void;
    readonly onOutput?: (text: string) => void;
    /** The folders from which no program is started: those of an untrusted workspace. */
    readonly avoid?: readonly string[];
}

export class PrivateEnvironment {
    /**
     * @param folder the folder with environments.
     * @param wheel the wheel of the server.
     * @param requirements the packages that the server needs, with their hashes.
     * @param id identifies this wheel with these packages.
     */
    constructor(
        private readonly host: Host,
        private readonly folder: string,
        private readonly wheel: string,
        private readonly requirements: string,
        private readonly id: string,
    ) {}

    /** The server in the environment; undefined if it does not exist yet. */
    server(): Promise<Server | undefined> {
        return this.serverIn(this.id);
    }

    /** The server of an earlier version of the extension, which shows that the user has agreed to its installation. */
    async older(): Promise<Server | undefined> {
        for (const name of await this.host.list(this.folder)) {
            const other = name === this.id ? undefined : await this.serverIn(name);
            if (other !== undefined) return other;
        }
        return undefined;
    }

    /**
     * Create the environment.
     *
     * @param preferred interpreters to try before those on PATH.
     */
    async install(preferred: readonly string[], options: InstallOptions = {}): Promise<Server | Failure> {
        const { signal, onOutput, onStep, avoid } = options;
        const limits = { ...(signal && { signal }), ...(onOutput && { onOutput }) };
        onStep?.("python");
        let failure: Failure = { kind: "no-python" };
        for await (const python of pythons(this.host, preferred, avoid)) {
            onStep?.("venv");
            await this.host.remove(this.home);
            const made = await this.host.run(python.executable, ["-I", "-m", "venv", this.home], limits);
            if (made.status !== 0) {
                failure = { kind: "no-venv", python: python.version, detail: words(made.err, made.out) };
                continue; // another Python may have the missing modules
            }
            onStep?.("packages");
            for (const alternatives of await this.installed()) {
                let ended: Ended | undefined;
                for (const what of alternatives) {
                    const pip = ["-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input", ...what];
                    ended = await this.host.run(this.python, pip, limits);
                    if (ended.status === 0 || signal?.aborted) break;
                }
                if (ended !== undefined && ended.status !== 0) {
                    await this.host.remove(this.home);
                    return { kind: "no-packages", python: python.version, detail: words(ended.err, ended.out) };
                }
            }
            return this.finish(python);
        }
        return failure;
    }

    /**
     * Compile the kernel of the model checker in the environment, unless an earlier attempt was completed. Without a C
     * compiler, the plain Python kernel is used, which is slower.
     */
    async compile(onOutput: (text: string) => void): Promise<void> {
        const mark = path.join(this.home, KERNEL_MARK);
        if ((await this.server()) === undefined || (await this.host.read(mark)) !== undefined) return;
        const ended = await this.host.run(this.python, ["-I", "-m", "as2fm_lsp.cli.build_kernel"], { onOutput });
        if (ended.status !== 0 && ended.status !== CANNOT_COMPILE) return; // interrupted: the next start tries again
        await this.host.write(mark, JSON.stringify({ compiled: ended.status === 0 }));
    }

    /** The arguments of the consecutive calls of `pip install`. Of the alternatives, the first that succeeds counts. */
    private async installed(): Promise<string[][][]> {
        const packages = ["--require-hashes", "--only-binary", ":all:", "-r", this.requirements];
        const contained = path.join(path.dirname(this.requirements), "packages");
        if ((await this.host.list(contained)).length === 0) {
            return [[packages], [["--no-index", "--no-deps", this.wheel]]];
        }
        const local = ["--no-index", "--find-links", contained];
        // A wheel with a compiled kernel for this Python is preferred to the wheel for every platform.
        const server = [...local, "--find-links", path.dirname(this.wheel), "--no-deps", "as2fm-lsp"];
        return [[[...local, ...packages], packages], [server]];
    }

    private async finish(python: Python): Promise<Server | Failure> {
        const asked = await this.host.run(this.python, ["-I", "-m", "as2fm_lsp", "--version"]);
        const version = /^as2fm-lsp (\S+)/.exec(asked.out)?.[1];
        if (asked.status !== 0 || version === undefined) {
            await this.host.remove(this.home);
            return { kind: "no-packages", python: python.version, detail: words(asked.err, asked.out) };
        }
        await this.host.write(path.join(this.home, MARK), JSON.stringify({ version, python: python.version }));
        for (const name of await this.host.list(this.folder)) {
            if (name !== this.id) await this.host.remove(path.join(this.folder, name));
        }
        return this.asServer(this.id, version);
    }

    private async serverIn(name: string): Promise<Server | undefined> {
        const mark = await this.host.read(path.join(this.folder, name, MARK));
        const version = mark === undefined ? undefined : versionIn(mark);
        return version === undefined ? undefined : this.asServer(name, version);
    }

    private asServer(name: string, version: string): Server {
        return { origin: "private", command: this.pythonIn(name), args: ["-I", "-m", "as2fm_lsp"], version };
    }

    private get home(): string {
        return path.join(this.folder, this.id);
    }

    private get python(): string {
        return this.pythonIn(this.id);
    }

    private pythonIn(name: string): string {
        return path.join(this.folder, name, ...(this.host.windows ? ["Scripts", "python.exe"] : ["bin", "python"]));
    }
}

function versionIn(mark: string): string | undefined {
    try {
        const content: unknown = JSON.parse(mark);
        if (typeof content !== "object" || content === null || !("version" in content)) return undefined;
        return typeof content.version === "string" ? content.version : undefined;
    } catch {
        return undefined;
    }
}

/** The last lines of the output of a program, which usually contain the reason of a failure. */
function words(...texts: readonly string[]): string {
    const said = texts.map((text) => text.trim()).filter((text) => text !== "");
    return (said[0] ?? "").split("\n").slice(-8).join("\n");
}
