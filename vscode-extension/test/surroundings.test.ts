// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import { test } from "node:test";
import { run } from "../src/server/run";
import { isInside, safeFolder, safeVariables } from "../src/server/surroundings";

test("a program is not started in the folder of the workspace and imports no modules from there", async () => {
    const workspace = fs.mkdtempSync(path.join(os.tmpdir(), "as2fm-workspace-"));
    const [before, named] = [process.cwd(), process.env["PYTHONPATH"]];
    try {
        fs.writeFileSync(path.join(workspace, "hostile.py"), "print('started')");
        process.chdir(workspace);
        process.env["PYTHONPATH"] = `${path.delimiter}.${path.delimiter}relative`;
        const ended = await run("python3", ["-c", "import os; print(os.getcwd()); import hostile"]);
        assert.equal(ended.out.trim(), fs.realpathSync(safeFolder()));
        assert.match(ended.err, /No module named 'hostile'/);
    } finally {
        process.chdir(before);
        if (named === undefined) delete process.env["PYTHONPATH"];
        else process.env["PYTHONPATH"] = named;
        fs.rmSync(workspace, { recursive: true });
    }
});

test("absolute entries of PYTHONPATH stay", () => {
    const named = ["/opt/ros/lib", "", ".", "lib", "/opt/x"].join(path.delimiter);
    const safe = safeVariables({ PYTHONPATH: named });
    assert.equal(safe["PYTHONPATH"], ["/opt/ros/lib", "/opt/x"].join(path.delimiter));
    assert.ok(!("PYTHONPATH" in safeVariables({})));
});

test("inside of a folder", () => {
    assert.ok(isInside("/ws/.venv/bin/python", ["/other", "/ws"]));
    assert.ok(isInside("/ws", ["/ws"]));
    assert.ok(!isInside("/wsx/python", ["/ws"]));
    assert.ok(!isInside("/usr/bin/python", ["/ws"]));
    assert.ok(!isInside("/usr/bin/python", []));
});
