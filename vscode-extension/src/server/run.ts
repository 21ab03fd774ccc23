// SPDX-License-Identifier: Apache-2.0
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { safeFolder, safeVariables } from "./surroundings";

/** The result of a program. `status` is null if it could not be started, was killed or took too long. */
export interface Ended {
    readonly status: number | null;
    readonly out: string;
    readonly err: string;
}

export interface RunOptions {
    /** The time limit in ms. */
    readonly timeout?: number;
    readonly signal?: AbortSignal;
    readonly onOutput?: (text: string) => void;
    /** Called with each line of the standard output, instead of collecting them. */
    readonly onLine?: (line: string) => void;
}

/**
 * Run a program to its end, with a working folder outside of the workspace. Never throws. An abort kills the program;
 * the worker processes of the server end with it.
 */
export function run(command: string, args: readonly string[], options: RunOptions = {}): Promise<Ended> {
    return new Promise((resolve) => {
        const out: string[] = [];
        const err: string[] = [];
        const child = spawn(command, args, {
            stdio: ["ignore", "pipe", "pipe"],
            windowsHide: true,
            cwd: safeFolder(),
            env: { ...process.env, ...safeVariables(process.env) },
            ...(options.timeout === undefined ? {} : { timeout: options.timeout }),
            ...(options.signal === undefined ? {} : { signal: options.signal, killSignal: "SIGKILL" as const }),
        });
        const collect = (into: string[]) => (text: string) => {
            into.push(text);
            options.onOutput?.(text);
        };
        const { onLine } = options;
        if (onLine) createInterface({ input: child.stdout }).on("line", onLine);
        else child.stdout.setEncoding("utf8").on("data", collect(out));
        child.stderr.setEncoding("utf8").on("data", collect(err));
        child.on("error", (error) => {
            resolve({ status: null, out: out.join(""), err: [...err, error.message].join("") });
        });
        child.on("close", (status) => {
            resolve({ status, out: out.join(""), err: err.join("") });
        });
    });
}
