// SPDX-License-Identifier: Apache-2.0
/** Invariants of package.json: no suspicious characters, existing pictures, and steps that can be completed. */

import assert from "node:assert/strict";
import * as fs from "node:fs";
import { test } from "node:test";

interface Step {
    readonly id: string;
    readonly description: string;
    readonly media: { readonly image: Readonly<Record<string, string>>; readonly altText: string };
    readonly completionEvents: readonly string[];
}

interface Manifest {
    readonly contributes: {
        readonly configurationDefaults: Readonly<Record<string, Readonly<Record<string, unknown>>>>;
        readonly walkthroughs: readonly [{ readonly steps: readonly Step[] }];
        readonly commands: readonly { readonly command: string }[];
        readonly debuggers: readonly [
            {
                readonly when: string;
                readonly configurationAttributes: {
                    readonly launch: {
                        readonly properties: Readonly<Record<string, { readonly description: string }>>;
                    };
                };
            },
        ];
        readonly menus: Readonly<Record<string, readonly { readonly command: string; readonly when: string }[]>>;
    };
}

const { contributes } = JSON.parse(fs.readFileSync("package.json", "utf8")) as Manifest;
const texts = JSON.parse(fs.readFileSync("package.nls.json", "utf8")) as Readonly<Record<string, string>>;
const steps = contributes.walkthroughs[0].steps;

test("no operator of JANI is highlighted as an ambiguous character", () => {
    const source = fs.readFileSync("../server/roaml/jani/operators.py", "utf8");
    const operators = [...source.matchAll(/^ {4}[A-Z_]+ = "([^"]+)"/gm)].map(([, symbol]) => symbol ?? "");
    const unusual = Array.from(`${operators.join("")}∀∃`).filter((character) => character > "\u007f");
    assert.ok(unusual.length > 6);
    for (const language of ["[ascxml]", "[scxml]", "[jani]"]) {
        const allowed = contributes.configurationDefaults[language]?.["editor.unicodeHighlight.allowedCharacters"];
        for (const character of unusual) {
            assert.equal((allowed as Record<string, boolean> | undefined)?.[character], true, character);
        }
    }
});

test("each step of the walkthrough has a picture for each kind of theme", () => {
    for (const { id, media } of steps) {
        assert.deepEqual(Object.keys(media.image).sort(), ["dark", "hc", "hcLight", "light"], id);
        for (const file of Object.values(media.image)) {
            assert.equal(fs.readFileSync(file).subarray(1, 4).toString(), "PNG", file);
        }
        assert.ok(texts[media.altText.replaceAll("%", "")], media.altText);
    }
});

test("each step is completed by an event of the extension, and the last one is the verification", () => {
    const commands = new Set(contributes.commands.map(({ command }) => command));
    const source = ["steps.ts", "documents.ts", "server.ts"].map((name) =>
        fs.readFileSync(`src/editor/${name}`, "utf8"),
    );
    const contexts = ["running", "inSystem", "fixed", "mocked", "translated", "verified"];
    for (const { id, completionEvents } of steps) {
        assert.ok(completionEvents.length > 0, id);
        for (const event of completionEvents) {
            const [kind, name = ""] = event.split(":");
            if (kind === "onCommand") assert.ok(commands.has(name), event);
            else {
                const context = name.replace("as2fm.", "");
                assert.ok(contexts.includes(context) && source.some((text) => text.includes(context)), event);
            }
        }
    }
    const last = steps.at(-1);
    assert.equal(last?.id, "verify");
    assert.match(texts["walkthrough.verify.description"] ?? "", /command:as2fm\.verifySystem/);
    const palette = contributes.menus["commandPalette"]?.find(({ command }) => command === "as2fm.verifySystem");
    assert.match(palette?.when ?? "", /isWorkspaceTrusted/);
});

test("each attribute of a debug configuration is documented and explained", () => {
    const { debuggers } = contributes;
    const attributes = debuggers[0].configurationAttributes.launch.properties;
    const page = fs.readFileSync("../docs/debugging.md", "utf8");
    const documented = [...page.matchAll(/^\| ((?:`\w+`(?:, )?)+) \|/gm)].flatMap(([, names = ""]) =>
        names.split(", "),
    );
    for (const [name, { description }] of Object.entries(attributes)) {
        assert.ok(documented.includes(`\`${name}\``), name);
        assert.ok(texts[description.replaceAll("%", "")], description);
    }
});

test("nothing can be debugged in an untrusted workspace", () => {
    assert.equal(contributes.debuggers[0].when, "isWorkspaceTrusted");
});
