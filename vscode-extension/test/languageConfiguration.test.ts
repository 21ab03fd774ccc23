// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import { test } from "node:test";

interface Configuration {
    readonly wordPattern: string;
    readonly indentationRules: { readonly increaseIndentPattern: string; readonly decreaseIndentPattern: string };
}

function read(name: string): Configuration {
    return JSON.parse(fs.readFileSync(name, "utf8")) as Configuration;
}

const ASCXML = read("language-configuration.json");

function words(text: string, { wordPattern } = ASCXML): string[] {
    return [...text.matchAll(new RegExp(wordPattern, "g"))].map(([word]) => word);
}

test("words have dashes, numbers their sign and point; a dot ends a word, so that fields are asked for behind it", () => {
    assert.deepEqual(words('event="robot.go-home" expr="_msg.data + -1.5"'), [
        ...["event", "robot", "go-home", "expr", "_msg", "data", "-1.5"],
    ]);
    assert.deepEqual(words('"exp": "seen.valid"', read("language-configuration-jani.json")), ["exp", "seen.valid"]);
});

test("a start tag increases the indentation, an end tag decreases it", () => {
    const { increaseIndentPattern, decreaseIndentPattern } = ASCXML.indentationRules;
    const opens = (line: string) => new RegExp(increaseIndentPattern).test(line);
    const closes = (line: string) => new RegExp(decreaseIndentPattern).test(line);
    assert.ok(opens('<state id="a">'));
    assert.ok(opens('    <transition cond="a &lt; b" target="x">'));
    for (const line of ['<state id="a"/>', '<state id="a" />', "<expr>1</expr>", "</state>", "<!-- a -->", "<?xml?>"]) {
        assert.ok(!opens(line), line);
    }
    assert.ok(closes("    </state>"));
    assert.ok(!closes("<state>"));
});
