// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { folded } from "../src/verification/folded";

const SUMMARY = "never_empty failed in trace 3 after 200 steps; 8 turns matter.";
const LONG = `By chance (0.5), the arm drops the block at 5.000 s (arm.ascxml:42), ${"and then it goes on, ".repeat(9)}${SUMMARY}`;

test("a short text is shown as it is", () => {
    assert.deepEqual(folded(SUMMARY, "Failed."), { message: SUMMARY, lines: [] });
});

test("of a long text, a summary is shown, and the list has the whole text in lines", () => {
    const { message, lines } = folded(LONG, SUMMARY);
    assert.equal(message, SUMMARY);
    assert.equal(lines.join(" "), LONG);
    assert.ok(lines.length > 3 && lines.every(({ length }) => length <= 64));
});
