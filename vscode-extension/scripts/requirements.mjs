// SPDX-License-Identifier: Apache-2.0
// Renews requirements.txt, which lists the packages in the private environment of the extension: each with its version
// and the hashes of all its files, for every system and every Python that the server supports. Run it when the
// dependencies in pyproject.toml change, and to use newer versions.
import { execFileSync } from "node:child_process";
import * as fs from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import { fileURLToPath } from "node:url";

const UV = "uv==0.13.8";
const OLDEST_PYTHON = "3.10";
const HEAD = `# Written by scripts/requirements.mjs. What the private environment is made of, besides the server itself.
`;

const here = fileURLToPath(new URL("..", import.meta.url));
const target = path.join(here, "requirements.txt");
const work = fs.mkdtempSync(path.join(os.tmpdir(), "as2fm-requirements-"));
try {
    const python = process.env.PYTHON ?? "python3";
    execFileSync(python, ["-I", "-m", "venv", work], { stdio: "inherit" });
    const bin = path.join(work, process.platform === "win32" ? "Scripts" : "bin");
    execFileSync(path.join(bin, "python"), ["-I", "-m", "pip", "install", "--quiet", UV], { stdio: "inherit" });
    const compiled = execFileSync(
        path.join(bin, "uv"),
        [
            ...["pip", "compile", "--quiet", "--universal", "--python-version", OLDEST_PYTHON, "--generate-hashes"],
            ...["--no-header", "--no-annotate", "--no-emit-index-url", "--no-emit-find-links", "--upgrade"],
            path.join(here, "..", "pyproject.toml"),
        ],
        { encoding: "utf8", maxBuffer: 1 << 26 },
    );
    fs.writeFileSync(target, HEAD + compiled);
} finally {
    fs.rmSync(work, { recursive: true, force: true });
}
