// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { test } from "node:test";
import { tellState } from "../src/editor/wording";
import type { Failure, Server } from "../src/server/server";

const SERVER: Server = { origin: "private", command: "/x/python", args: [], version: "0.1.0" };

const FAILURES: Record<Failure["kind"], Failure> = {
    "no-server": { kind: "no-server" },
    "configured-server": { kind: "configured-server", path: "/opt/lsp", detail: "" },
    "no-python": { kind: "no-python" },
    "no-venv": { kind: "no-venv", python: "3.11", detail: "" },
    "no-packages": { kind: "no-packages", python: "3.11", detail: "" },
    start: { kind: "start", server: SERVER, detail: "Traceback\nImportError: lxml" },
    crashes: { kind: "crashes", server: SERVER, count: 4, detail: "" },
    internal: { kind: "internal", detail: "oops" },
};

test("every failure contains and offers an action", () => {
    const packageJson = JSON.parse(fs.readFileSync("package.json", "utf8")) as {
        contributes: { commands: { command: string }[] };
    };
    const known = packageJson.contributes.commands.map(({ command }) => command);
    known.push("as2fm.openServerSetting", "as2fm.getPython");
    for (const failure of Object.values(FAILURES)) {
        const { severity, long, actions } = tellState({ kind: "failed", failure });
        assert.notEqual(severity, "quiet");
        assert.ok(long.length > 20 && !long.includes("{"), long);
        assert.ok(actions.length > 0);
        for (const { command } of actions) assert.ok(known.includes(command), command);
    }
});

test("the texts that help", () => {
    const long = (failure: Failure) => tellState({ kind: "failed", failure }).long;
    assert.match(long(FAILURES["no-python"]), /Python 3\.10 or newer.*apt install python3 python3-venv/);
    assert.match(long(FAILURES["no-venv"]), /apt install python3-venv/);
    assert.match(long(FAILURES["no-packages"]), /index-url.*as2fm\.server\.path/);
    assert.match(long(FAILURES["configured-server"]), /\/opt\/lsp/);
    assert.match(long(FAILURES.start), /ImportError: lxml$/);
});

test("states", () => {
    assert.equal(tellState({ kind: "running", server: SERVER }).short, "0.1.0");
    assert.match(tellState({ kind: "installing", step: "venv" }).long, /private Python environment/);
    assert.equal(tellState({ kind: "searching" }).severity, "quiet");
    assert.equal(tellState({ kind: "starting", server: SERVER }).short, "starting");
    assert.deepEqual(tellState({ kind: "stopped" }).actions[0]?.command, "as2fm.restart");
});

test("all strings are in the files for translators", () => {
    const bundle = JSON.parse(fs.readFileSync("l10n/bundle.l10n.json", "utf8")) as Record<string, string>;
    const folder = "src/editor";
    const code = fs.readdirSync(folder).map((name) => fs.readFileSync(path.join(folder, name), "utf8"));
    const used = code.flatMap((text) =>
        [...text.matchAll(/l10n\.t\(\s*"((?:[^"\\]|\\.)*)"/g)].map(([, string]) => string),
    );
    assert.deepEqual(Object.keys(bundle).sort(), [...new Set(used)].sort());
    const manifest = fs.readFileSync("package.json", "utf8");
    const named = new Set([...manifest.matchAll(/"%([\w.]+)%"/g)].map(([, key]) => key));
    const strings = JSON.parse(fs.readFileSync("package.nls.json", "utf8")) as Record<string, string>;
    assert.deepEqual([...named].sort(), Object.keys(strings).sort());
});
