# SPDX-License-Identifier: Apache-2.0
"""Opens a model with an error in each editor, configured as in docs/editors.md, and checks what the editor shows. The
exit status is 1 if the finding is missing, or if the correct name is not completed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
NOTES = HERE.parents[1] / "docs" / "editors.md"
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1] / "server")]

SECONDS = 120
"""The time limit of an editor."""

MISTAKE = "undeclared-variable"
MEANT = "count"


def setup(section: str, language: str) -> str:
    """The last piece of configuration in a section of docs/editors.md, which is for the versions in Debian."""
    text = NOTES.read_text(encoding="utf-8")
    part = re.split(r"^## ", text.partition(f"\n## {section}\n")[2], maxsplit=1, flags=re.MULTILINE)[0]
    texts: list[str] = re.findall(rf"^```{language}\n(.*?)^```$", part, re.MULTILINE | re.DOTALL)
    return texts[-1]


def shown(command: list[str], file: Path) -> list[str]:
    """The output of a script in an editor for a file."""
    environment = {**os.environ, "HOME": str(file.parent), "XDG_CONFIG_HOME": str(file.parent)}
    done = subprocess.run(
        [*command], cwd=file.parent, env=environment, capture_output=True, text=True, timeout=SECONDS, check=False
    )
    print(done.stdout + done.stderr, end="")
    return (done.stdout + done.stderr).splitlines()


def main() -> int:
    import clock  # noqa: PLC0415 - the folders above come first

    editors = {
        "Emacs": ("elisp", "setup.el", ["emacs", "-q", "--batch", "-f", "package-initialize"]),
        "Neovim": ("lua", "setup.lua", ["nvim", "--clean", "--headless"]),
    }
    failed = []
    for name, (language, script, command) in editors.items():
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder).resolve() / "clock.ascxml"
            clock.write(file.parent, clock=clock.WRONG_CLOCK)
            (file.parent / ".git").mkdir()
            configuration = file.parent / script
            configuration.write_text(setup(name, language), encoding="utf-8")
            if name == "Emacs":
                command += ["-l", str(configuration), "-l", str(HERE / "emacs.el"), str(file)]
            else:
                command += ["-c", f"luafile {configuration}", "-c", f"edit {file}", "-c", f"luafile {HERE}/neovim.lua"]
            lines = shown(command, file)
        if f"diagnostic: {MISTAKE}" not in lines:
            failed.append(f"{name} does not show `{MISTAKE}`")
        if f"completion: {MEANT}" not in lines and "completion: not offered" not in lines:
            failed.append(f"{name} does not complete `{MEANT}`")
    print(*failed or ["all editors show what they should"], sep="\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
