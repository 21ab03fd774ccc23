# SPDX-License-Identifier: Apache-2.0
"""`python tests/packaging/vsix_offline.py VSIX`: install the server from a VSIX, without network.

The calls of pip are those of `vscode-extension/src/server/environment.ts`, in a new environment, with an index that
does not answer. Then the main job is done (`smoke.py`).
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
import venv
import zipfile
from pathlib import Path

NOWHERE = "http://127.0.0.1:9"
"""An address that refuses connections."""


def main(vsix: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        zipfile.ZipFile(vsix).extractall(folder)
        dist = Path(folder, "extension", "dist")
        began = time.monotonic()
        venv.create(Path(folder, "environment"), with_pip=True)
        python = str(Path(folder, "environment", "bin", "python"))
        pip = (python, "-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input", "--quiet")
        local = ("--no-index", "--find-links", str(dist / "packages"))
        hashed = ("--require-hashes", "--only-binary", ":all:", "-r", str(dist / "requirements.txt"))
        environment = {**os.environ, "PIP_INDEX_URL": NOWHERE, "http_proxy": NOWHERE, "https_proxy": NOWHERE}
        subprocess.run([*pip, *local, *hashed], check=True, env=environment)
        server = (*local, "--find-links", str(dist / "wheel"), "--no-deps", "as2fm-lsp")
        subprocess.run([*pip, *server], check=True, env=environment)
        print(f"installed without network in {time.monotonic() - began:.0f} s")
        subprocess.run([python, str(Path(__file__).parent / "smoke.py")], check=True, env=environment)


if __name__ == "__main__":
    main(sys.argv[1])
