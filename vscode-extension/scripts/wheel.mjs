// SPDX-License-Identifier: Apache-2.0
// Builds the wheel in the extension. It is valid for every platform, because it contains no compiled parts.
import { execFileSync } from "node:child_process";
import * as fs from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL("..", import.meta.url));
const root = path.join(here, "..");
const SOURCES = ["pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE", "server", "schemas"];
const LEFT_OUT = /__pycache__|\.egg-info|\.(so|pyd|c|pyc)$/;

const own = path.join(root, ".venv", "bin", "python");
/** The Python that builds. */
export const python = process.env.PYTHON ?? (fs.existsSync(own) ? own : "python3");
const work = fs.mkdtempSync(path.join(os.tmpdir(), "as2fm-wheel-"));
try {
    // Files that an earlier build left in the tree must not get into the wheel, so it is built from a copy.
    for (const name of SOURCES) {
        fs.cpSync(path.join(root, name), path.join(work, "source", name), {
            recursive: true,
            filter: (file) => !LEFT_OUT.test(path.relative(root, file)),
        });
    }
    const options = ["-m", "pip", "--disable-pip-version-check", "wheel", "--quiet", "--no-deps", "--wheel-dir", work];
    // The environment of the tests contains the packages for building; elsewhere pip installs them.
    if (python === own) options.push("--no-build-isolation");
    execFileSync(python, [...options, path.join(work, "source")], {
        stdio: "inherit",
        // The same sources give the same bytes, so the private environment is not created again.
        env: { ...process.env, AS2FM_PURE_PYTHON: "1", SOURCE_DATE_EPOCH: "315532800" },
    });
    const wheel = fs.readdirSync(work).find((name) => name.endsWith(".whl"));
    if (!wheel?.endsWith("-py3-none-any.whl")) throw new Error(`${wheel} does not run everywhere`);
    const target = path.join(here, "dist", "wheel");
    fs.rmSync(target, { recursive: true, force: true });
    fs.mkdirSync(target, { recursive: true });
    fs.copyFileSync(path.join(work, wheel), path.join(target, wheel));
} finally {
    fs.rmSync(work, { recursive: true, force: true });
}
