// SPDX-License-Identifier: Apache-2.0
// Runs the unit tests: of the modules that do not depend on the editor, and of the grammars.
import { spawnSync } from "node:child_process";
import * as fs from "node:fs";
import * as path from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const here = fileURLToPath(new URL("..", import.meta.url));
const out = path.join(here, "out", "unit");
fs.rmSync(out, { recursive: true, force: true });
await esbuild.build({
    absWorkingDir: here,
    entryPoints: fs
        .readdirSync(path.join(here, "test"))
        .filter((name) => name.endsWith(".test.ts"))
        .map((name) => `test/${name}`),
    outdir: out,
    bundle: true,
    platform: "node",
    format: "esm",
    target: "node20",
    outExtension: { ".js": ".mjs" },
    alias: { vscode: "./test/support/vscode.ts" },
    external: ["vscode-oniguruma", "vscode-textmate", "vscode-languageserver-protocol/node.js"],
    logLevel: "warning",
});
const tests = fs.readdirSync(out).map((name) => path.join(out, name));
const done = spawnSync(process.execPath, ["--test", "--test-reporter=dot", ...tests], { stdio: "inherit" });
process.exit(done.status ?? 1);
