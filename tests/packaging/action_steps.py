# SPDX-License-Identifier: Apache-2.0
"""`python tests/packaging/action_steps.py ACTION PATHS`: run the shell steps of a GitHub action as the runner does.

The environment is that of `RUNNER_TEMP`, in which as2fm-lsp is installed already; the step that installs it is left
out. Inputs have their defaults, except `paths`, `sarif` and `verify`.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from ruamel.yaml import YAML


def main(action: str, paths: str) -> None:
    definition = YAML(typ="safe").load(Path(action))
    with tempfile.TemporaryDirectory() as folder:
        sarif = str(Path(folder, "findings.sarif"))
        values = {name: str(given.get("default", "")) for name, given in definition["inputs"].items()}
        values |= {"paths": paths, "sarif": sarif, "verify": "examples/grid_world/main.xml"}
        values["verify-arguments"] = '--expect "arrives >= 0.9"'
        for step in definition["runs"]["steps"]:
            if "run" not in step or step["name"] == "Install":
                continue
            env = dict(os.environ)
            for variable, text in step.get("env", {}).items():
                name = text.removeprefix("${{ inputs.").removesuffix(" }}")
                env[variable] = values[name]
            print(f"-- {step['name']}")
            subprocess.run(["bash", "-e", "-o", "pipefail", "-c", step["run"]], env=env, check=True)
        assert '"version": "2.1.0"' in Path(sarif).read_text(encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
