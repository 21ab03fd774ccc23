// SPDX-License-Identifier: Apache-2.0
/** Scopes of the grammar: below each line, carets mark characters, followed by the last part of their scope. */

import assert from "node:assert/strict";
import * as fs from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import oniguruma from "vscode-oniguruma";
import textmate from "vscode-textmate";

const GRAMMARS: Record<string, string> = {
    "text.xml.ascxml": "syntaxes/ascxml.tmLanguage.json",
    "source.json.jani": "syntaxes/jani.tmLanguage.json",
};

const wasm = fs.readFileSync(createRequire(`${process.cwd()}/`).resolve("vscode-oniguruma/release/onig.wasm"));
const registry = new textmate.Registry({
    onigLib: oniguruma.loadWASM(wasm).then(() => ({
        createOnigScanner: (patterns: string[]) => new oniguruma.OnigScanner(patterns),
        createOnigString: (text: string) => new oniguruma.OnigString(text),
    })),
    loadGrammar: (scope) => {
        const file = GRAMMARS[scope];
        return Promise.resolve(
            file === undefined ? null : textmate.parseRawGrammar(fs.readFileSync(file, "utf8"), file),
        );
    },
});

async function check(marked: string): Promise<void> {
    const grammar = await registry.loadGrammar("text.xml.ascxml");
    assert.ok(grammar);
    let stack = textmate.INITIAL;
    let line = "";
    let tokens: textmate.IToken[] = [];
    for (const each of marked.split("\n")) {
        const mark = /^(\s*)(\^+) (.+)$/.exec(each);
        if (!mark) {
            line = each;
            ({ tokens, ruleStack: stack } = grammar.tokenizeLine(each, stack));
            continue;
        }
        const [, before = "", carets = "", scope = ""] = mark;
        for (let i = before.length; i < before.length + carets.length; i++) {
            const token = tokens.find(({ startIndex, endIndex }) => startIndex <= i && i < endIndex);
            const found = token?.scopes.at(-1) ?? "";
            assert.ok(found.startsWith(scope), `${JSON.stringify(line[i])} in ${line} is ${found}, not ${scope}`);
        }
    }
}

test("tags, attributes, comments", () =>
    check(`
<?xml version="1.0"?>
  ^^^ entity.name.tag
<state id="driving" other='x &lt; y'>
^ punctuation.definition.tag
 ^^^^^ entity.name.tag
       ^^ entity.other.attribute-name
          ^ punctuation.definition.string.begin
           ^^^^^^^ string.quoted.double
                    ^^^^^ entity.other.attribute-name
                             ^^^^ constant.character.entity
</state>
^^ punctuation.definition.tag
  ^^^^^ entity.name.tag
<!-- TYPE sum:int64 -->
     ^^^^ keyword.other.type
          ^^^ variable.other
              ^^^^^ support.type
<!-- as2fm: ignore[x] -->
     ^^^^^^^^^^^^^ keyword.other.suppression
`));

test("expressions in attributes", () =>
    check(`
<transition cond="_msg.data &lt; 30.5 &amp;&amp; !done" target="a"/>
                  ^^^^ variable.language
                      ^ punctuation.accessor
                       ^^^^ variable.other.property
                            ^^^^ keyword.operator
                                 ^^^^ constant.numeric
                                      ^^^^^^^^^^ keyword.operator
                                                 ^ keyword.operator
                                                  ^^^^ variable.other.readwrite
                                                        ^^^^^^ entity.other.attribute-name
                                                                ^ string.quoted.double
<assign location="pose.x" expr="Math.max(level - 1, {'a': 'it'}['a'])"/>
                  ^^^^ variable.other.readwrite
                      ^ punctuation.accessor
                       ^ variable.other.property
                                ^^^^ support.class
                                     ^^^ support.function
                                        ^ punctuation.brackets
                                               ^ keyword.operator
                                                 ^ constant.numeric
                                                     ^^^ string.quoted.single
<data expr='"s"' id="true"/>
            ^^^ string.quoted.double
                     ^^^^ string.quoted.double
`));

test("expressions as text", () =>
    check(`
<expr>1 + true</expr>
 ^^^^ entity.name.tag
      ^ constant.numeric
        ^ keyword.operator
          ^^^^ constant.language
              ^^ punctuation.definition.tag
<expr><bt_get_input key="goal"/></expr>
       ^^^^^^^^^^^^ entity.name.tag
                         ^^^^ string.quoted.double
<if cond="a">
 ^^ entity.name.tag
`));

test("incomplete text does not change the highlighting of what follows", () =>
    check(`
<assign location="a
  expr="b" />
<state id="next">
<state id="after">
 ^^^^^ entity.name.tag
           ^^^^^ string.quoted.double
<assign expr='x
</assign>
<a b
<state id="last">
 ^^^^^ entity.name.tag
`));
