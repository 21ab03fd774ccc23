# SPDX-License-Identifier: Apache-2.0
"""`python tests/packaging/wheel_content.py WHEEL`: compare the content of a wheel with the checkout.

A wheel contains each file of `server/` and `schemas/` that git tracks, the metadata, and the modules of `COMPILED` of
`setup.py`: as extensions, or as C source if the wheel has no platform. It contains nothing else.
"""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main(wheel: str) -> None:
    listed = zipfile.ZipFile(wheel).namelist()
    content = {name for name in listed if ".dist-info/" not in name}
    tracked = subprocess.run(
        ["git", "ls-files", "server", "schemas"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    expected = {re.sub("^schemas/", "roaml/schemas/", path.removeprefix("server/")) for path in tracked}
    compiled = re.findall(r'^    "(roaml\.[a-z_.]+)",$', (ROOT / "setup.py").read_text(encoding="utf-8"), re.MULTILINE)
    assert compiled, "setup.py lists no compiled module"
    is_universal = wheel.endswith("-none-any.whl")
    for module in compiled:
        stem = module.replace(".", "/")
        (extra,) = (name for name in content - expected if name.startswith(f"{stem}."))
        assert extra.endswith(".c") is is_universal, extra
        content.remove(extra)
    assert content == expected, sorted(content ^ expected)
    print(f"{len(listed)} files, {Path(wheel).stat().st_size / 1e6:.1f} MB: as in the checkout")


if __name__ == "__main__":
    main(sys.argv[1])
