// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { Recall, type Store } from "../src/server/recall";
import type { Server } from "../src/server/server";

const SERVER: Server = { origin: "python", command: "/env/bin/python", args: ["-m", "as2fm_lsp"], version: "0.1.0" };
const WISHES = ["", "", true, "0.1.0-abc"];

/** Stores only values that JSON supports, as VS Code does. */
class Kept implements Store {
    text = "{}";
    updates = 0;

    get(key: string): unknown {
        return (JSON.parse(this.text) as Record<string, unknown>)[key];
    }
    update(key: string, value: unknown): Promise<void> {
        this.updates++;
        this.text = JSON.stringify({ [key]: value });
        return Promise.resolve();
    }
}

test("the server that ran last is known in the next window", async () => {
    const kept = new Kept();
    assert.equal(new Recall(kept).server(WISHES), undefined);
    await new Recall(kept).keep(WISHES, SERVER);
    assert.deepEqual(new Recall(kept).server(WISHES), SERVER);
});

test("with other settings it is not expected", async () => {
    const recall = new Recall(new Kept());
    await recall.keep(WISHES, SERVER);
    assert.equal(recall.server(["", "", false, "0.1.0-abc"]), undefined);
    await recall.keep(["", "", false, "0.1.0-abc"], SERVER);
    assert.equal(recall.server(WISHES), undefined);
});

test("unchanged data is not written again", async () => {
    const kept = new Kept();
    const recall = new Recall(kept);
    await recall.keep(WISHES, SERVER);
    await recall.keep(WISHES, { ...SERVER });
    assert.equal(kept.updates, 1);
    await recall.keep(WISHES, { ...SERVER, version: "0.2.0" });
    assert.equal(kept.updates, 2);
});

test("data of another version, or no data, is not a server", async () => {
    const kept = new Kept();
    for (const server of [null, "as2fm-lsp", {}, { ...SERVER, args: "-m" }, { ...SERVER, args: [1] }]) {
        await kept.update("server", { settings: WISHES, server });
        assert.equal(new Recall(kept).server(WISHES), undefined);
    }
    await kept.update("server", [SERVER]);
    assert.equal(new Recall(kept).server(WISHES), undefined);
});
