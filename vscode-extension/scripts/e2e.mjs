// SPDX-License-Identifier: Apache-2.0
// Runs the end-to-end tests with the packaged extension. An argument is a pattern for the names of tests.
// `--measure` measures the start instead, `--measure timeline` the timeline of a long run; `--pictures` also renews the
// pictures of the READMEs, of the documents and of the walkthrough, and without a pattern runs only the tests that take
// these.
import { execFileSync, spawnSync } from "node:child_process";
import * as fs from "node:fs";
import * as path from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

/** Parts of the names of the tests that take the published pictures. */
const PICTURED = [
    "one click installs the server",
    "a machine: its states",
    "the behavior tree and its ports",
    "the ROS graph: keyboard",
    "plain SCXML beside",
    "the Test Explorer runs",
    "a counterexample leads",
    "mocks are edited",
    "F5 goes to the dropped block",
    "the timeline shows the run",
    "the walkthrough's pictures",
];

const here = fileURLToPath(new URL("..", import.meta.url));
execFileSync("sh", [path.join(here, "e2e/workbench/setup.sh")], { stdio: "inherit" });
const packaged = path.join(here, "as2fm.vsix");
if (!fs.existsSync(packaged)) throw new Error("as2fm.vsix is missing: npm run package");
const newer = changedSince(fs.statSync(packaged).mtimeMs);
if (newer) throw new Error(`as2fm.vsix is older than ${newer}: npm run package`);
const out = path.join(here, "out", "e2e");
const output = path.join(here, "out", "e2e-output");
fs.rmSync(out, { recursive: true, force: true });
fs.rmSync(output, { recursive: true, force: true }); // pictures of an earlier run are not those of this one
const [first, ...others] = process.argv.slice(2);
const measures = first === "--measure";
const measure = others[0] === "timeline" ? "measureTimeline" : "measure";
await esbuild.build({
    absWorkingDir: here,
    entryPoints: [measures ? `e2e/${measure}.ts` : "e2e/all.test.ts"],
    outdir: out,
    bundle: true,
    platform: "node",
    format: "esm",
    target: "node20",
    outExtension: { ".js": ".mjs" },
    external: ["playwright-core"],
    logLevel: "warning",
});
const file = path.join(out, measures ? `${measure}.mjs` : "all.test.mjs");
const options = measures ? [] : ["--test", "--test-reporter=spec"];
const names = measures ? [] : [first, ...others].filter((name) => name !== undefined && !name.startsWith("--"));
const pictures = first === "--pictures";
const patterns = (pictures && names.length === 0 ? PICTURED : names).map((name) => `--test-name-pattern=${name}`);
const env = pictures ? { ...process.env, AS2FM_PICTURES: "yes" } : process.env;
const done = spawnSync(process.execPath, [...options, ...patterns, file], { stdio: "inherit", env });
if (done.status === 0 && pictures) {
    for (const folder of ["screenshots", "walkthrough", "../docs/pictures"]) {
        for (const name of fs.readdirSync(path.join(here, folder))) {
            const renewed = path.join(output, name);
            // With a pattern, only some pictures are taken.
            if (fs.existsSync(renewed)) fs.copyFileSync(renewed, path.join(here, folder, name));
            else if (names.length === 0 && name.endsWith(".png")) {
                throw new Error(`no test took ${folder}/${name}: add its test to PICTURED`);
            }
        }
    }
}
process.exit(done.status ?? 1);

/** A source of the package that has changed since a time in ms; undefined if there is none. */
function changedSince(time) {
    for (const folder of ["src", "syntaxes", "../server", "../schemas"]) {
        for (const name of fs.readdirSync(path.join(here, folder), { recursive: true, encoding: "utf8" })) {
            const file = path.join(here, folder, name);
            if (/\.(ts|css|json|py|pxd|xsd|toml)$/.test(name) && fs.statSync(file).mtimeMs > time) return file;
        }
    }
    return undefined;
}
