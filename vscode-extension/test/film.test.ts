// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Moment, MomentsRequest } from "../src/stage/contract";
import { Film } from "../src/stage/view/film";

const NOTHING = { nodes: {}, edges: [] };

function moment(step: number, position: number, isEnd = false, stop: string | null = null): Moment {
    const activity = { system: NOTHING, tree: NOTHING, ros: NOTHING };
    return { step, position, time: position, isEnd, stop, activity, verdicts: {} };
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
    const film = new Film({ axis: "steps", rate: 4 }, 10, 10);
    const first = asked(film);
    assert.deepEqual(first, { axis: "steps", from: 10, by: 1, count: first.count, after: 10 });
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
    const film = new Film({ axis: "steps", rate: 64 }, 0, 0);
    const first = asked(film);
    assert.ok(first.by > 3 && first.by < 4, `${first.by}`);
    film.add(first, steps(first));
    film.play(1);
    assert.ok(film.shown && film.shown.step > 60 && film.shown.step <= 64);
});

test("a film in real time shows the last step up to the time", () => {
    const film = new Film({ axis: "time", rate: 1 }, 2, 6);
    const first = asked(film);
    film.add(first, [moment(7, 1.5), moment(9, 2), moment(12, 2.5), moment(20, 2.5)]);
    assert.equal(film.shown?.step, 9);
    film.play(0.4);
    assert.equal(film.shown.step, 9);
    film.play(0.1);
    assert.equal(film.shown.step, 20);
});

test("a film ends with the run, and without an answer", () => {
    const film = new Film({ axis: "steps", rate: 16 }, 0, 0);
    const first = asked(film);
    film.add(first, steps(first, 5));
    film.play(0.1);
    assert.equal(film.isOver, false);
    film.play(10);
    assert.equal(film.shown?.step, 5);
    assert.equal(film.isOver, true);
    assert.equal(film.wants(), undefined);
    const other = new Film({ axis: "steps", rate: 16 }, 0, 0);
    other.add(asked(other), null);
    assert.equal(other.isOver, true);
});

test("a film ends where a breakpoint stops the run, and begins after one", () => {
    const film = new Film({ axis: "steps", rate: 16 }, 3, 3);
    const first = asked(film);
    assert.equal(first.after, 3, "the breakpoint at which the run has stopped does not stop it again");
    film.add(first, [moment(4, 4), moment(5, 5, false, "/arm/command")]);
    const before = film.shown;
    assert.equal(before, undefined, "what the run shows already");
    film.play(1);
    assert.equal(film.shown?.stop, "/arm/command");
    assert.equal(film.isOver, true);
});
