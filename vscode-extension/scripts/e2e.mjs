// SPDX-License-Identifier: Apache-2.0
// Runs the end-to-end tests with the packaged extension. Arguments choose tests by name.
import { execFileSync, spawnSync } from "node:child_process";
import * as fs from "node:fs";
import * as path from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const here = fileURLToPath(new URL("..", import.meta.url));
execFileSync("sh", [path.join(here, "e2e/workbench/setup.sh")], { stdio: "inherit" });
if (!fs.existsSync(path.join(here, "as2fm.vsix"))) throw new Error("as2fm.vsix is missing: npm run package");
const out = path.join(here, "out", "e2e");
fs.rmSync(out, { recursive: true, force: true });
const wanted = process.argv.slice(2);
const names = fs.readdirSync(path.join(here, "e2e")).filter((name) => name.endsWith(".test.ts"));
const chosen = names.filter((name) => wanted.length === 0 || wanted.some((each) => name.startsWith(each))).sort();
await esbuild.build({
    absWorkingDir: here,
    entryPoints: chosen.map((name) => `e2e/${name}`),
    outdir: out,
    bundle: true,
    platform: "node",
    format: "esm",
    target: "node20",
    outExtension: { ".js": ".mjs" },
    external: ["playwright-core"],
    logLevel: "warning",
});
const tests = fs.readdirSync(out).map((name) => path.join(out, name));
const done = spawnSync(process.execPath, ["--test", "--test-concurrency=1", "--test-reporter=spec", ...tests], {
    stdio: "inherit",
});
process.exit(done.status ?? 1);
