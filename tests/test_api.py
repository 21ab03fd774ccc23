# SPDX-License-Identifier: Apache-2.0
"""The public interface of the library: all names in its signatures can be imported from it, and a check imports few
modules."""

from __future__ import annotations

import ast
import builtins
import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from roaml import api
from roaml.project import explored_findings

FOREIGN = {"Callable", "Executor", "Iterable", "Iterator", "Mapping", "Sequence"}
"""Names of the standard library in signatures."""
ANSWERS = [
    api.CheckResult,
    api.Counterexample,
    api.Exact,
    api.Expectation,
    api.LoadedSystem,
    api.Migration,
    api.Refusal,
    api.Result,
    api.SampledResult,
    api.VerificationTarget,
    api.Traces,
    api.Verdict,
    api.Verifier,
]
ROOT = Path(__file__).resolve().parents[1]

HEAVY = (
    "roaml.smc.kernel",
    "roaml.smc.run",
    "roaml.verification",
    "asyncio",
    "lsprotocol",
    "multiprocessing",
    "pygls",
    "socket",
    "ssl",
    "urllib.request",
)
"""Modules that a check must not import."""


def test_every_name_can_be_imported() -> None:
    assert len(set(api.__all__)) == len(api.__all__)
    for name in api.__all__:
        assert getattr(api, name) is not None
    with pytest.raises(AttributeError):
        api.no_such_name  # type: ignore[attr-defined]  # noqa: B018


FUNCTIONS = [name for name in api.__all__ if inspect.isfunction(getattr(api, name))]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_signatures_name_what_can_be_imported(name: str) -> None:
    assert named_in(getattr(api, name)) <= set(api.__all__)


@pytest.mark.parametrize("kind", ANSWERS, ids=lambda kind: kind.__name__)
def test_answers_name_what_can_be_imported(kind: type) -> None:
    names = {name for annotation in annotations(kind) for name in names_of(annotation)}
    for name, member in vars(kind).items():
        function = member.fget if isinstance(member, property) else member
        if not name.startswith("_") and inspect.isfunction(function):
            names |= named_in(function)
    assert names <= set(api.__all__)


def annotations(kind: type) -> list[str]:
    """The annotations of all fields of a class of records."""
    hints = {name: str(hint) for base in kind.__mro__ for name, hint in vars(base).get("__annotations__", {}).items()}
    return [hints[field] for field in kind.__struct_fields__]  # type: ignore[attr-defined]


def named_in(function: object) -> set[str]:
    """The names in a signature, without those of Python and its standard library."""
    return {name for text in function.__annotations__.values() for name in names_of(str(text))}  # type: ignore[attr-defined]


def names_of(annotation: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(annotation)):
        if isinstance(node, ast.Name) and not hasattr(builtins, node.id) and node.id not in FOREIGN:
            yield node.id


def imported_by(*arguments: str) -> set[str]:
    """The modules that a command has imported at its end."""
    code = f"import sys\nsys.argv[1:] = {arguments!r}\nfrom as2fm_lsp.__main__ import main\n" + (
        "try:\n    main()\nfinally:\n    print(*sorted(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    return set(done.stdout.splitlines()[-1].split())


def own(modules: set[str]) -> set[str]:
    """The modules of this project, without those of single rules, whose number grows with the rules."""
    names = {name for name in modules if name.partition(".")[0] in ("roaml", "as2fm_lsp")}
    return {name for name in names if not (name.startswith("roaml.rules.") and name.count(".") == 3)}


EXPENSIVE = {"asyncio", "dataclasses", "hashlib", "importlib.resources", "inspect", "logging", "tempfile"}
"""Modules of Python that take 2 to 12 ms each, and that no short command needs."""


def test_a_check_imports_nothing_heavy() -> None:
    assert imported_by("--check", __file__) & {*HEAVY, *EXPENSIVE, "typing_extensions"} == set()


def test_the_start_of_a_check_does_not_grow() -> None:
    """A module costs 0.4 ms at each start. Raise the number only for modules that each check of a system needs."""
    check = ("--check", str(ROOT / "examples/delivery_robot/main.xml"))
    assert len(own(imported_by(*check))) <= 368  # also explores states and judges properties
    modules = imported_by(*check, "--ignore", ",".join(explored_findings.CODES))
    assert len(own(modules)) <= 276
    assert modules & {*EXPENSIVE, "lxml", "xmlschema", "typing_extensions", "roaml.lower.system"} == set()


NOT_FOR_JANI = {"lxml", "multiprocessing", "roaml.expr.tree", "roaml.scxml.model", "roaml.views.story", "xml.etree"}
"""What a quick verification of a model in JANI does not need."""


def test_the_start_of_a_verification_of_jani_does_not_grow(tmp_path: Path) -> None:
    model = tmp_path / "model.jani"
    model.write_text(COIN)
    modules = imported_by("verify", str(model), "--jobs", "1")
    assert len(own(modules)) <= 179
    assert modules & {*NOT_FOR_JANI, *EXPENSIVE, "pathlib", "pickle", "typing_extensions"} == set()


COIN = """{
    "jani-version": 1, "name": "coin", "type": "dtmc", "actions": [],
    "variables": [{
        "name": "n", "type": {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 2}, "initial-value": 0
    }],
    "automata": [{
        "name": "A", "locations": [{"name": "l"}], "initial-locations": ["l"],
        "edges": [{"location": "l", "guard": {"exp": {"op": "<", "left": "n", "right": 1}}, "destinations": [
            {"location": "l", "probability": {"exp": 0.5}, "assignments": [{"ref": "n", "value": 1}]},
            {"location": "l", "probability": {"exp": 0.5}, "assignments": [{"ref": "n", "value": 2}]}
        ]}]
    }],
    "system": {"elements": [{"automaton": "A"}], "syncs": [{"synchronise": [null]}]},
    "properties": [{"name": "two", "expression": {
        "op": "filter", "fun": "values", "states": {"op": "initial"},
        "values": {"op": "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "n", "right": 2}}}
    }}]
}"""


FETCH = str(ROOT / "examples/fetch_tree/fetch.xml")


def test_a_tree_with_mocks_is_a_target() -> None:
    (known,) = api.verify(api.target(FETCH), ["succeeds"], exact_if_small=True)
    assert api.as_target(api.target(FETCH)).path == FETCH
    assert known.answer is not None
    sure = api.target(FETCH, mocks={"*": "1 in 1 s"}, entries={"shelf": "1;2;3"}, tick_rate=2)
    (result,) = api.verify(sure, ["succeeds"])
    assert result.answer is not None
    assert result.answer.value == 1
    with pytest.raises(api.MockError, match="not a probability"):
        api.target(FETCH, mocks={"*": "2"})


def test_draw_returns_a_picture() -> None:
    tree = api.draw(FETCH, mocks={"CloseGripper": "0.5 in 2 s"})
    assert tree.kind is api.DiagramKind.TREE
    assert tree._repr_svg_() == tree.svg
    assert "0.5 in 2 s" in tree.svg
    with pytest.raises(api.DrawingError, match="not a system"):
        api.draw(FETCH, "system")


def test_columns_have_a_cell_for_each_state() -> None:
    run = api.session(api.load(str(ROOT / "examples/assembly_robot/main.xml")), seed=3)
    run.jump(60)
    table = api.columns(run)
    assert {len(cells) for cells in table.values()} == {61}
    assert table["step"] == list(range(61))
    assert run.position == 60


def test_a_diagnostic_is_one_line() -> None:
    path = str(ROOT / "examples/delivery_robot/tree.xml")
    text = Path(path).read_text().replace("<Charge />", "<Chrge />")
    first, *_ = api.check([path], texts={path: text}).diagnostics
    assert str(first).startswith(f"{path}:8:18: error: there is no node `Chrge`")
    assert str(first).endswith("[unknown-node]")


RAISING = ("api", "experiments", "explicit", "jani", "lower", "mocks", "smc", "verification")
"""The packages whose messages are errors and results for users of the library."""


def test_no_message_of_the_library_names_an_option_of_the_command_line() -> None:
    """Those who use the library have no command line. Docstrings may name options."""
    library, named = Path(api.__file__).parents[1], []
    for path in (path for package in RAISING for path in (library / package).rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            body = getattr(node, "body", None)
            for part in body if isinstance(body, list) else ():
                if isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant):
                    part.value.value = None  # a docstring
        constants = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
        named += [(path.name, text) for text in constants if isinstance(text, str) and re.search(OPTION, text)]
    assert named == []


OPTION = r"(?<![\w<!-])--[a-z]{3,}"
