// SPDX-License-Identifier: Apache-2.0
// Creates as2fm.vsix. In a clean checkout, `npm ci && npm run package` is enough. With `-- --target linux-x64`, it is
// as2fm-linux-x64.vsix, which contains all packages and needs no network; `--wheels FOLDER` names compiled wheels.
import * as fs from "node:fs";
import * as path from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { createVSIX } from "@vscode/vsce";
import { downloadPackages } from "./packages.mjs";
import { python } from "./wheel.mjs";

const here = fileURLToPath(new URL("..", import.meta.url));
const { target, wheels } = parseArgs({ options: { target: { type: "string" }, wheels: { type: "string" } } }).values;
const name = target === undefined ? "as2fm.vsix" : `as2fm-${target}.vsix`;
const packagePath = `${here}${name}`;
if (target === undefined) fs.rmSync(path.join(here, "dist", "packages"), { recursive: true, force: true });
else downloadPackages(here, python, target, wheels);
fs.copyFileSync(`${here}../LICENSE`, `${here}LICENSE`);
fs.copyFileSync(`${here}../CHANGELOG.md`, `${here}CHANGELOG.md`);
await createVSIX({
    cwd: here,
    packagePath,
    ...(target !== undefined && { target }),
    dependencies: false,
    allowMissingRepository: true,
    rewriteRelativeLinks: false,
});
console.log(`${name}: ${(fs.statSync(packagePath).size / 1e6).toFixed(2)} MB`);
