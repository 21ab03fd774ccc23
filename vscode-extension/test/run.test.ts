// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import { test } from "node:test";
import { thisHost } from "../src/server/host";
import { run } from "../src/server/run";

test("a program's output and status", async () => {
    const code = "console.log('out'); console.error('err'); process.exit(3)";
    assert.deepEqual(await run(process.execPath, ["-e", code]), { status: 3, out: "out\n", err: "err\n" });
});

test("a missing program, one that takes too long, one that is cancelled", async () => {
    const missing = await run("/no/such/program", []);
    assert.equal(missing.status, null);
    assert.match(missing.err, /ENOENT/);
    const forever = ["-e", "setInterval(() => 0, 1000)"];
    assert.equal((await run(process.execPath, forever, { timeout: 50 })).status, null);
    const abort = new AbortController();
    const running = run(process.execPath, forever, { signal: abort.signal });
    abort.abort();
    assert.equal((await running).status, null);
});

test("programs are searched only in absolute folders of PATH", async () => {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "as2fm-path-"));
    const [before, cwd] = [process.env["PATH"], process.cwd()];
    try {
        for (const name of ["tool", "data"]) fs.writeFileSync(path.join(folder, name), "");
        fs.chmodSync(path.join(folder, "tool"), 0o755);
        process.chdir(folder);
        process.env["PATH"] = ["", ".", "relative"].join(path.delimiter);
        assert.equal(await thisHost.which("tool"), undefined);
        process.env["PATH"] = folder;
        assert.equal(await thisHost.which("tool"), path.join(folder, "tool"));
        assert.equal(await thisHost.which("data"), undefined);
    } finally {
        process.chdir(cwd);
        process.env["PATH"] = before;
        fs.rmSync(folder, { recursive: true });
    }
});
