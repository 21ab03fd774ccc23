// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { DebugAdapter } from "../src/server/debugAdapter";

/** Answers requests by their names; `move` is followed by an event, `refuse` fails, and `crash` ends the process. */
const ADAPTER = `
let text = "";
function send(message) {
    const content = JSON.stringify(message);
    process.stdout.write("Content-Length: " + content.length + "\\r\\n\\r\\n" + content);
}
process.stdin.on("data", (data) => {
    text += data;
    for (;;) {
        const head = /^Content-Length: (\\d+)\\r\\n\\r\\n/.exec(text);
        if (!head || text.length < head[0].length + Number(head[1])) return;
        const { seq, command, arguments: given } = JSON.parse(text.slice(head[0].length, head[0].length + Number(head[1])));
        text = text.slice(head[0].length + Number(head[1]));
        if (command === "crash") process.exit(1);
        const success = command !== "refuse";
        send({ type: "response", request_seq: seq, command, success, message: "not now", body: given });
        if (command === "move") send({ type: "event", event: "stopped" });
    }
});
`;

function start(): { readonly adapter: DebugAdapter; readonly ended: Promise<void> } {
    let end = (): void => undefined;
    const ended = new Promise<void>((resolve) => {
        end = resolve;
    });
    const adapter = new DebugAdapter(process.execPath, ["-e", ADAPTER], () => {
        end();
    });
    return { adapter, ended };
}

test("requests are answered, refused, or followed by an event", async () => {
    const { adapter, ended } = start();
    assert.deepEqual(await adapter.request("choices", { step: 1 }), { step: 1 });
    await assert.rejects(adapter.request("refuse"), /not now/);
    let stops = 0;
    adapter.on("stopped", () => stops++);
    await adapter.until("stopped", "move");
    assert.equal(stops, 1);
    adapter.stop();
    await ended;
});

test("the end of the process rejects what is expected of it", async () => {
    const { adapter, ended } = start();
    await assert.rejects(adapter.until("stopped", "crash"), /has ended/);
    await ended;
    await assert.rejects(adapter.request("choices"));
});

test("a program that does not exist has ended", async () => {
    let end = (): void => undefined;
    const ended = new Promise<void>((resolve) => {
        end = resolve;
    });
    const adapter = new DebugAdapter("/nonexistent/adapter", [], () => {
        end();
    });
    const refused = assert.rejects(adapter.request("initialize"));
    await ended;
    await refused;
});
