// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { handshake, type Starting } from "../src/server/handshake";
import type { Exit } from "../src/server/supervisor";

const NEVER = new Promise<never>(() => undefined);

function client(start: () => Promise<void>, isRunning = false): Starting {
    return { start, isRunning: () => isRunning };
}

function program(exit?: Partial<Exit>) {
    const ended = exit ? Promise.resolve({ status: null, signal: null, detail: "", ...exit }) : NEVER;
    const process = { ended, isKilled: false, kill: () => (process.isKilled = true) };
    return process;
}

test("a client that runs is not disturbed", async () => {
    const process = program();
    await handshake(
        client(() => Promise.resolve(), true),
        process,
    );
    assert.ok(!process.isKilled);
});

// The library does each of these when the process ends during the handshake.
const ways: Record<string, () => Promise<void>> = {
    resolves: () => Promise.resolve(),
    rejects: () => Promise.reject(new Error("Pending response rejected since connection got disposed")),
    waits: () => NEVER,
};
for (const [way, start] of Object.entries(ways)) {
    test(`the output of a process that ends is the reason, if the client ${way}`, async () => {
        await assert.rejects(handshake(client(start), program({ status: 3, detail: "no license\n" })), {
            message: "no license",
        });
    });

    test(`without an output, the status is the reason, if the client ${way}`, async () => {
        await assert.rejects(handshake(client(start), program({ status: 3 })), { message: "it ended with status 3" });
        await assert.rejects(handshake(client(start), program({ signal: "SIGKILL" })), {
            message: "it ended with status SIGKILL",
        });
    });
}

test("a process that goes on after a failed handshake is killed, and the client states the reason", async () => {
    const process = program();
    await assert.rejects(
        handshake(
            client(() => Promise.reject(new Error("refused"))),
            process,
        ),
        { message: "refused" },
    );
    assert.ok(process.isKilled);
});
