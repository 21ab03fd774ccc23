// SPDX-License-Identifier: Apache-2.0
import { setTimeout as wait } from "node:timers/promises";
import type { Exit } from "./supervisor";

/** The time in ms within which a process that has closed its connection ends. */
const GRACE_MS = 2000;

/** The part of a language client that starts it. */
export interface Starting {
    start(): Promise<void>;
    isRunning(): boolean;
}

/** The process of a server. */
export interface ServerProcess {
    /** Settles when the process has ended, for whatever reason. */
    readonly ended: Promise<Exit>;
    kill(): unknown;
}

/**
 * Starts a client of the process. Throws if the handshake fails, with the error output of the process if it has ended
 * by itself.
 *
 * The promise of `start` does not show whether it worked: the library resolves it, too, if the connection is closed
 * during the handshake, and rejects it with words about the connection, perhaps before the process has ended.
 */
export async function handshake(client: Starting, process: ServerProcess): Promise<void> {
    let exit: Exit | undefined;
    const ended = process.ended.then((result) => (exit = result));
    const started = client.start().catch((error: unknown) => error);
    const error = await Promise.race([started, ended.then(() => undefined)]);
    if (client.isRunning()) return;
    await Promise.race([ended, wait(GRACE_MS)]);
    process.kill();
    throw new Error(reason(exit, error));
}

function reason(exit: Exit | undefined, error: unknown): string {
    if (exit === undefined) return error instanceof Error ? error.message : "it closed the connection";
    return exit.detail.trim() || `it ended with status ${exit.status ?? exit.signal ?? "unknown"}`;
}
