// SPDX-License-Identifier: Apache-2.0
// Creates as2fm.vsix. In a clean checkout, `npm ci && npm run package` is enough.
import * as fs from "node:fs";
import { fileURLToPath } from "node:url";
import { createVSIX } from "@vscode/vsce";
import "./wheel.mjs";

const here = fileURLToPath(new URL("..", import.meta.url));
const packagePath = `${here}as2fm.vsix`;
fs.copyFileSync(`${here}../LICENSE`, `${here}LICENSE`);
fs.copyFileSync(`${here}../CHANGELOG.md`, `${here}CHANGELOG.md`);
await createVSIX({
    cwd: here,
    packagePath,
    dependencies: false,
    allowMissingRepository: true,
    rewriteRelativeLinks: false,
});
console.log(`as2fm.vsix: ${(fs.statSync(packagePath).size / 1e6).toFixed(2)} MB`);
