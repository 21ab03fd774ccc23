// SPDX-License-Identifier: Apache-2.0
/** The folders of the extension, of the repository, and of what the tests write. */

import * as fs from "node:fs";
import * as path from "node:path";

export const EXTENSION = path.resolve(import.meta.dirname, "..", "..");
export const ROOT = path.resolve(EXTENSION, "..");
/** The version of the extension and of its server. */
export const { version: VERSION } = JSON.parse(fs.readFileSync(path.join(EXTENSION, "package.json"), "utf8")) as {
    version: string;
};
export const OUTPUT = path.join(EXTENSION, "out", "e2e-output");
