// SPDX-License-Identifier: Apache-2.0
/** The folders of the extension, of the repository, and of what the tests write. */

import * as path from "node:path";

export const EXTENSION = path.resolve(import.meta.dirname, "..", "..");
export const ROOT = path.resolve(EXTENSION, "..");
export const OUTPUT = path.join(EXTENSION, "out", "e2e-output");
