# SPDX-License-Identifier: Apache-2.0
"""Invariants of the code itself."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import roaml.rules
from as2fm_lsp.cli.init import template
from roaml import api
from roaml.diagnostics import Severity
from roaml.rules import RULES, expansion_rules, parser_rules, property_rules

ROOT = Path(__file__).resolve().parents[1]
SERVER = ROOT / "server"
MODULES = sorted(SERVER.rglob("*.py"))

# Who may touch the disk: the user's files, or the package's own resources; or asks the system for its free memory.
READS_USER_FILES = ("roaml/disk.py", "roaml/project/", "roaml/api/", "roaml/interfaces/search.py", "as2fm_lsp/")
READS_RESOURCES = (
    "roaml/smc/memory.py",
    "roaml/explicit/plain.py",
    "roaml/figures/themes.py",
    "roaml/language/resources.py",
    "roaml/language/grammar.py",
    "roaml/language/validate.py",
    "roaml/libraries/__init__.py",
    "roaml/libraries/declarations.py",
    "roaml/rules/__init__.py",
)
DISK_MODULES = {"os", "pathlib", "shutil", "tempfile", "glob", "io", "subprocess", "socket", "urllib"}


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def test_layers() -> None:
    command = [str(Path(sys.executable).parent / "lint-imports"), "--no-cache"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_only_some_modules_touch_the_disk() -> None:
    offenders = []
    for path in MODULES:
        name = path.relative_to(SERVER).as_posix()
        if name.startswith(READS_USER_FILES) or name in READS_RESOURCES:
            continue
        offenders += [f"{name}: {used}" for used in disk_access(path)]
    assert not offenders


def disk_access(path: Path) -> Iterator[str]:
    """Imports and calls with which a module could read or write files."""
    for node in ast.walk(parsed(path)):
        match node:
            case ast.Import(names=names):
                yield from (name.name for name in names if name.name.partition(".")[0] in DISK_MODULES)
            case ast.ImportFrom(module=str(module)) if module.partition(".")[0] in DISK_MODULES:
                yield module
            case ast.Call(func=ast.Name(id="open")):
                yield "open()"


# A test for each module would take longer than what it does.
def test_modules_open_with_the_licence() -> None:
    begin = "# SPDX-License-Identifier: Apache-2.0\n"
    assert [path for path in MODULES if not path.read_text(encoding="utf-8").startswith(begin)] == []


def test_modules_say_what_they_are_for() -> None:
    assert [path for path in MODULES if not ast.get_docstring(parsed(path))] == []


def test_every_rule_module_is_registered() -> None:
    folder = Path(roaml.rules.__file__).parent
    modules = {path.stem for path in folder.rglob("*.py") if re.search(r"^RULE = ", path.read_text(), re.MULTILINE)}
    modules |= {
        rule.code.replace("-", "_") for rule in (*expansion_rules.RULES, *parser_rules.RULES, *property_rules.RULES)
    }
    assert modules == {rule.code.replace("-", "_") for rule in RULES}


def test_rules_are_registered_in_the_order_of_their_codes() -> None:
    codes = [rule.code for rule in RULES]
    assert codes == sorted(set(codes))


def test_reference_manual_is_current() -> None:
    done = subprocess.run(
        [sys.executable, str(ROOT / "docs/build.py"), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


BASES = (".", "server", "server/as2fm_lsp", "server/roaml", "server/roaml/rules")
"""The folders to which paths in CONTRIBUTING.md are relative."""
INVENTED = re.compile(r"GROUP|Name|NAME|my_rule")


def test_files_that_the_guide_names_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`([\w./]+/[\w.]+\.(?:ascxml|json|md|py|txt|xml|xsd))`", text))
    assert len(named) > 30
    real = {name for name in named if not INVENTED.search(name)}
    assert sorted(name for name in real if not any((ROOT / base / name).is_file() for base in BASES)) == []


def test_example_is_what_init_writes() -> None:
    folder = ROOT / "examples" / "delivery_robot"
    written = {path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*") if path.is_file()}
    assert written == dict(template("delivery_robot"))


def test_examples_are_clean() -> None:
    result = api.check([str(ROOT / "examples")])
    assert len(result.files) >= 8
    found = [(Path(d.path).name, d.code) for d in result.diagnostics if d.severity >= Severity.WARNING]
    # The variant of the case study with a bug is there to be found.
    assert found == [("tree_with_bug.xml", "never-ticked")]


def test_nothing_names_a_machine_or_registry() -> None:
    """Committed files contain no path of a machine and no registry host."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    wrong = []
    for name in listed:
        path = ROOT / name
        if path.suffix in (".png", ".ico") or path == Path(__file__) or not path.is_file():
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        if re.search(r"/work/|/root/|registry\.npmjs|pypi\.org", text):
            wrong.append(name)
    assert not wrong


def test_importing_compiles_no_regular_expression() -> None:
    """`roaml.regex` delays the compilation until the first use."""
    assert [f"{path}:{line}" for path in MODULES for line in compiled_at_import(parsed(path))] == []


def compiled_at_import(tree: ast.AST) -> Iterator[int]:
    """The lines outside of functions that call `re.compile`."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node) == "re.compile":
            yield node.lineno
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            yield from compiled_at_import(node)


def test_compilation_at_import_is_seen() -> None:
    text = "import re\nA = [re.compile('a')]\nclass B:\n    c = re.compile('c')\ndef d():\n    return re.compile('d')\n"
    assert list(compiled_at_import(ast.parse(text))) == [2, 4]
