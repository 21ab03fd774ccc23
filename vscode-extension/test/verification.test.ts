// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Verified } from "../src/protocol";
import { outcomeOf } from "../src/verification/outcome";
import { chosen, type Test } from "../src/verification/selection";

const BARE: Verified = {
    property: "alarm",
    seconds: 1.25,
    short: "0.71 [0.66, 0.76]",
    verdict: "no expectation set",
    counterexample: true,
};
const MET = { expected: ">= 0.5", met: true, certain: true };
const STUCK = { level: "warning", text: "who waits for whom", example: { trace: 3 } } as const;
const ROW: Verified = { ...BARE, verdict: "met", expectations: [MET] };
const MISSED = { expected: ">= 0.95", met: false, certain: true };

test("a property without an expectation neither passes nor fails", () => {
    assert.deepEqual(outcomeOf(BARE), { kind: "unjudged", short: "0.71 [0.66, 0.76]" });
    const stuck = outcomeOf(BARE, { ...STUCK, level: "error" });
    assert.equal(stuck.kind, "failed");
});

test("an expected 1 that no trace contradicts says how many there were", () => {
    const all = { expected: "≥ 1", met: true, certain: false, unanimous: 200 };
    const outcome = outcomeOf({ ...ROW, expectations: [all] });
    assert.ok(outcome.kind === "passed" && outcome.unanimous === 200);
});

test("expectations decide", () => {
    assert.equal(outcomeOf({ ...ROW, expectations: [MET] }).kind, "passed");
    assert.deepEqual(outcomeOf({ ...ROW, expectations: [MET, MISSED] }), {
        kind: "failed",
        short: "0.71 [0.66, 0.76]",
        milliseconds: 1250,
        missed: [">= 0.95"],
        hasCounterexample: true,
    });
    const without = outcomeOf({ property: "alarm", expectations: [MISSED] });
    assert.ok(without.kind === "failed" && !without.hasCounterexample);
});

test("a system that gets stuck is reported, and fails its properties if that is an error", () => {
    const told = { short: "0.71 [0.66, 0.76]", milliseconds: 1250 };
    assert.deepEqual(outcomeOf(ROW, STUCK), {
        ...told,
        kind: "passed",
        uniform: [],
        unanimous: 0,
        stuck: "who waits for whom",
    });
    assert.deepEqual(outcomeOf(ROW, { ...STUCK, level: "error" }), {
        ...told,
        kind: "failed",
        missed: [],
        hasCounterexample: true,
        stuck: "who waits for whom",
    });
    const missed = outcomeOf({ ...ROW, expectations: [MISSED] }, STUCK);
    assert.ok(missed.kind === "failed" && missed.stuck === "who waits for whom");
});

test("nothing is reported if no trace got stuck", () => {
    for (const level of ["warning", "error"] as const)
        assert.deepEqual(outcomeOf(ROW, { ...STUCK, level, example: null }), outcomeOf(ROW));
    assert.deepEqual(outcomeOf(ROW, null), outcomeOf(ROW));
});

test("an expectation that only uniform choices are known to meet passes with a remark", () => {
    const warning = "this is the value under uniform choices";
    const only = { ...MET, under_uniform_choices_only: true };
    assert.deepEqual(outcomeOf({ ...ROW, expectations: [MET, only], warning }), {
        kind: "passed",
        short: "0.71 [0.66, 0.76]",
        milliseconds: 1250,
        uniform: [">= 0.5"],
        unanimous: 0,
        warning,
    });
});

test("an expectation that is accepted under uniform choices passes without a remark", () => {
    const uniformOf = (uniform: "accept" | "warn") => {
        const outcome = outcomeOf({
            ...ROW,
            expectations: [{ ...MET, under_uniform_choices_only: true, uniform }],
        });
        return outcome.kind === "passed" ? outcome.uniform : undefined;
    };
    assert.deepEqual(uniformOf("accept"), []);
    assert.deepEqual(uniformOf("warn"), [">= 0.5"]);
});

test("a warning is also reported for a failure", () => {
    const warning = "all 200 traces got stuck and say nothing about the property";
    const failed = outcomeOf({ ...ROW, expectations: [MISSED], warning });
    assert.ok(failed.kind === "failed" && failed.warning === warning);
});

test("a failed verification is an error, not a failure of the test", () => {
    const message = "a division by zero";
    assert.deepEqual(outcomeOf({ property: "alarm", error: { message } }), { kind: "errored", message });
});

interface Item extends Test<Item> {
    readonly children: Map<string, Item>;
}

function suite(id: string, ...names: readonly string[]): [string, Item] {
    const children = new Map<string, Item>();
    const made: Item = { id, children };
    for (const name of names) children.set(name, { id: `${id}#${name}`, parent: made, children: new Map() });
    return [id, made];
}

test("selection: all, suites, single properties, without excluded ones", () => {
    const all = new Map([suite("a", "x", "y"), suite("b", "x"), suite("empty")]);
    const [a, b] = [all.get("a"), all.get("b")];
    assert.ok(a && b);
    const ids = (include?: readonly Item[], exclude?: readonly Item[]) =>
        chosen(all, include, exclude).map(({ id }) => id);
    assert.deepEqual(ids(), ["a#x", "a#y", "b#x"]);
    assert.deepEqual(ids([b]), ["b#x"]);
    const [x, y] = a.children.values();
    assert.ok(x && y);
    assert.deepEqual(ids([y, a]), ["a#y", "a#x"]);
    assert.deepEqual(ids(undefined, [x, b]), ["a#y"]);
});
