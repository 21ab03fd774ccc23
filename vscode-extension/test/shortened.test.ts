// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { shortened } from "../src/verification/shortened";

test("a long text is shortened after a word", () => {
    assert.equal(shortened("The robot docks.", 16), "The robot docks.");
    assert.equal(shortened("The robot docks.", 15), "The robot…");
    assert.equal(shortened("The robot docks.", 10), "The robot…");
    assert.equal(shortened("The robot docks.", 9), "The…");
    assert.equal(shortened("never_empty_before", 9), "never_em…");
});
