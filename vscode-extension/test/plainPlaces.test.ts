// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { lineOf, placeOf } from "../src/editor/plainPlaces";
import type { PlainLine } from "../src/protocol";

const URI = "file:///m.ascxml";

function line(number: number, start: number, end: number): PlainLine {
    return {
        line: number,
        uri: URI,
        range: { start: { line: start, character: 0 }, end: { line: end, character: 9 } },
    };
}

const LINES = [line(0, 0, 0), line(2, 5, 20), line(3, 7, 9), line(4, 8, 8), line(6, 30, 31)];

test("the narrowest place around a position", () => {
    assert.equal(lineOf(LINES, URI, { line: 8, character: 3 }), 4);
    assert.equal(lineOf(LINES, URI, { line: 9, character: 0 }), 3);
    assert.equal(lineOf(LINES, URI, { line: 15, character: 0 }), 2);
});

test("a place without its own line maps to the line above", () => {
    assert.equal(lineOf(LINES, URI, { line: 25, character: 0 }), 4);
    assert.equal(lineOf(LINES, "file:///other", { line: 8, character: 0 }), undefined);
    assert.equal(lineOf([], URI, { line: 8, character: 0 }), undefined);
});

test("from the plain form to the source", () => {
    assert.equal(placeOf(LINES, 3)?.range.start.line, 7);
    assert.equal(placeOf(LINES, 5)?.range.start.line, 8);
    assert.equal(placeOf([], 5), undefined);
});
