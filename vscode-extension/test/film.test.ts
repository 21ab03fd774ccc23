// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Moment, MomentsRequest } from "../src/stage/contract";
import { Film, newlyFailed } from "../src/stage/view/film";

const NOTHING = { nodes: {}, edges: [] };

function moment(step: number, position: number, isEnd = false, verdicts: Moment["verdicts"] = {}): Moment {
    const activity = { system: NOTHING, tree: NOTHING, ros: NOTHING };
    return { step, position, time: position, isEnd, activity, verdicts };
}

/** Each step of a run, as it is asked for. */
function steps({ from, by, count }: MomentsRequest, end = Infinity): Moment[] {
    return Array.from({ length: count }, (_, index) => from + index * by)
        .filter((step) => step <= end)
        .map((step) => moment(step, step, step === end));
}

function asked(film: Film): MomentsRequest {
    const wanted = film.wants();
    assert.ok(wanted);
    return wanted;
}

test("a film plays steps at its speed, and waits for those that it does not know", () => {
    const film = new Film({ axis: "steps", rate: 4 }, 10);
    const first = asked(film);
    assert.deepEqual({ axis: first.axis, from: first.from, by: first.by }, { axis: "steps", from: 10, by: 1 });
    assert.equal(film.wants(), undefined, "one request at a time");
    film.play(5);
    assert.equal(film.isOver, false);
    film.add(first, steps(first));
    film.play(0.5);
    assert.equal(film.shown?.step, 12);
    film.play(1000);
    assert.equal(film.shown.step, first.from + first.count - 1);
    assert.equal(film.isOver, false);
    assert.equal(asked(film).from, first.from + first.count);
});

test("a fast film leaves out steps", () => {
    const film = new Film({ axis: "steps", rate: 64 }, 0);
    const first = asked(film);
    assert.ok(first.by > 3 && first.by < 4, `${first.by}`);
    film.add(first, steps(first));
    film.play(1);
    assert.ok(film.shown && film.shown.step > 60 && film.shown.step <= 64);
});

test("a film in real time shows the last step up to the time", () => {
    const film = new Film({ axis: "time", rate: 1 }, 2);
    const first = asked(film);
    film.add(first, [moment(7, 1.5), moment(9, 2), moment(12, 2.5), moment(20, 2.5)]);
    assert.equal(film.shown?.step, 9);
    film.play(0.4);
    assert.equal(film.shown.step, 9);
    film.play(0.1);
    assert.equal(film.shown.step, 20);
});

test("a film ends with the run, and without an answer", () => {
    const film = new Film({ axis: "steps", rate: 16 }, 0);
    const first = asked(film);
    film.add(first, steps(first, 5));
    film.play(0.1);
    assert.equal(film.isOver, false);
    film.play(10);
    assert.equal(film.shown?.step, 5);
    assert.equal(film.isOver, true);
    assert.equal(film.wants(), undefined);
    const other = new Film({ axis: "steps", rate: 16 }, 0);
    other.add(asked(other), null);
    assert.equal(other.isOver, true);
});

test("a property fails once", () => {
    const before = moment(1, 1, false, { safe: "undecided", live: "failed" });
    const after = moment(2, 2, false, { safe: "failed", live: "failed" });
    assert.deepEqual(newlyFailed(before, after), ["safe"]);
    assert.deepEqual(newlyFailed(after, after), []);
    assert.deepEqual(newlyFailed(undefined, after), [], "what failed before is not new");
});
