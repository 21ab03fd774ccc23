// SPDX-License-Identifier: Apache-2.0
// Downloads the packages that the server needs into `dist/packages`, for one platform and all supported Pythons, so that
// the extension needs no network. `--wheels FOLDER` adds the wheels with a compiled kernel in a folder.
import { execFileSync } from "node:child_process";
import * as fs from "node:fs";
import * as os from "node:os";
import * as path from "node:path";

const PYTHONS = ["3.10", "3.11", "3.12", "3.13", "3.14"];
const glibc = (machine) => ["manylinux_2_28", "manylinux_2_17", "manylinux2014"].map((tag) => `${tag}_${machine}`);
const mac = (machine, ...versions) => versions.map((version) => `macosx_${version}_${machine}`);
/** The targets of VS Code, and the tags of the wheels that run there, the preferred ones first. */
export const TARGETS = {
    "linux-x64": glibc("x86_64"),
    "linux-arm64": glibc("aarch64"),
    "alpine-x64": ["musllinux_1_2_x86_64"],
    "alpine-arm64": ["musllinux_1_2_aarch64"],
    "darwin-x64": [...mac("x86_64", "11_0", "10_15", "10_13", "10_9"), ...mac("universal2", "11_0", "10_9")],
    "darwin-arm64": [...mac("arm64", "14_0", "11_0"), ...mac("universal2", "11_0", "10_9")],
    "win32-x64": ["win_amd64"],
};

/**
 * @param here the folder of the extension.
 * @param python the Python whose pip downloads.
 * @param target a target of VS Code.
 * @param wheels a folder with wheels of the server; undefined if there are none.
 */
export function downloadPackages(here, python, target, wheels) {
    const folder = path.join(here, "dist", "packages");
    fs.rmSync(folder, { recursive: true, force: true });
    fs.mkdirSync(folder, { recursive: true });
    const tags = TARGETS[target];
    if (tags === undefined) throw new Error(`there is no target ${target}; it is one of ${Object.keys(TARGETS)}`);
    const work = fs.mkdtempSync(path.join(os.tmpdir(), "as2fm-packages-"));
    try {
        // pip compares the markers with the Python that runs it, not with the one for which it downloads.
        const requirements = fs.readFileSync(path.join(here, "requirements.txt"), "utf8").replace(/ ; [^\\\n]*/g, " ");
        fs.writeFileSync(path.join(work, "requirements.txt"), requirements);
        for (const version of PYTHONS) {
            const options = ["--no-deps", "--only-binary", ":all:", "--require-hashes", "--python-version", version];
            options.push(...tags.flatMap((tag) => ["--platform", tag]), "--dest", folder);
            options.push("-r", path.join(work, "requirements.txt"));
            const pip = ["-m", "pip", "--disable-pip-version-check", "download", "--quiet", ...options];
            execFileSync(python, pip, { stdio: "inherit" });
        }
    } finally {
        fs.rmSync(work, { recursive: true, force: true });
    }
    for (const name of wheels === undefined ? [] : fs.readdirSync(wheels)) {
        if (tags.some((tag) => name.includes(tag))) fs.copyFileSync(path.join(wheels, name), path.join(folder, name));
    }
}
