// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { counterpart, reversed, type Alignment } from "../src/stage/alignment";

/** The runs part at 2 s and at 3 s, because an automaton has waited longer. */
const TIMED: Alignment = {
    pairs: [
        [4, 6],
        [9, 7],
    ],
    here: { step: 12, time: 2, end: 40 },
    there: { step: 10, time: 3, end: 30 },
};
const UNTIMED: Alignment = { ...TIMED, here: { ...TIMED.here, time: null }, there: { ...TIMED.there, time: null } };

function steps(position: number) {
    return { axis: "steps", position };
}

test("up to where they part, both runs have finished the same turns", () => {
    const at = (step: number) => counterpart(TIMED, { step, time: 1 }, "time");
    assert.deepEqual([0, 3, 4, 8, 9, 11].map(at), [0, 0, 6, 6, 7, 7].map(steps));
    assert.deepEqual(at(12), steps(10));
});

test("after it, the same time has passed, also if they part at different times", () => {
    const { axis, position } = counterpart(TIMED, { step: 13, time: 2.5 }, "time");
    assert.equal(axis, "time");
    assert.ok(Math.abs(position - 3.5) < 1e-6 && position > 3.5, "rounding does not lose the state at this time");
    assert.ok(counterpart(TIMED, { step: 13, time: 2 }, "time").position >= 3);
});

test("the same number of steps, if the user chooses so, or if the model has no clock", () => {
    assert.deepEqual(counterpart(TIMED, { step: 15, time: 2.5 }, "steps"), steps(13));
    assert.deepEqual(counterpart(UNTIMED, { step: 15, time: null }, "time"), steps(13));
});

test("the second run can lead", () => {
    const at = (step: number) => counterpart(reversed(TIMED), { step, time: 1 }, "time");
    assert.deepEqual([5, 6, 7, 10].map(at), [0, 4, 9, 12].map(steps));
});
