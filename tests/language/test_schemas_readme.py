# SPDX-License-Identifier: Apache-2.0
"""The table of `schemas/README.md` says which schema a file is valid against; its commands work."""

from __future__ import annotations

import functools
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from lxml import etree

from roaml import api

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "schemas/README.md").read_text(encoding="utf-8")
_ROW = re.compile(r"^\| (`<.*?) \| (.*?) \| `(.*?)` \|$", re.MULTILINE)
SCHEMAS = {
    (root, namespace.strip("`").replace("none", "")): schema
    for roots, namespace, schema in _ROW.findall(README)
    for root in re.findall(r"<(\w+)>", roots)
}
MODELS = sorted(path for pattern in ("*.xml", "*.ascxml") for path in (ROOT / "examples").rglob(pattern))
MODELS = [path for path in MODELS if path.name != "package.xml"]


SYSTEMS = {name: ROOT / "examples" / name / "main.xml" for name in ("warehouse", "battery", "fleet")}
SYSTEMS["case_study"] = ROOT / "examples" / "case_study" / "main_with_bug.xml"
SYSTEMS["scaling"] = ROOT / "examples" / "scaling" / "robot" / "main.xml"
"""The examples with parameters, by the names of their folders."""


@functools.cache
def plain_files(name: str) -> dict[str, str]:
    """The files of an example without parameters and instances, by their paths."""
    return api.to_plain(api.load(str(SYSTEMS[name])))


def is_valid(schema: Path, text: bytes) -> bool:
    """The result of `xmllint --schema` or, if it is not installed, of libxml2."""
    if shutil.which("xmllint"):
        command = ["xmllint", "--noout", "--nonet", "--schema", str(schema), "-"]
        return subprocess.run(command, input=text, capture_output=True, check=False).returncode == 0
    return bool(etree.XMLSchema(etree.parse(schema)).validate(etree.fromstring(text)))


def schema_of(text: bytes) -> Path:
    name = etree.QName(etree.fromstring(text))
    return ROOT / "schemas" / SCHEMAS[name.localname, name.namespace or ""]


@pytest.mark.parametrize("path", MODELS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_example_is_valid_against_its_schema(path: Path) -> None:
    text = path.read_bytes()
    name, *_ = path.relative_to(ROOT / "examples").parts
    if name in SYSTEMS:  # a schema does not know that numbers may use parameters
        files, inside = plain_files(name), path.relative_to(SYSTEMS[name].parent).parts
        paths = ["/".join(inside), "/".join((name, *inside)), *(key for key in files if key.endswith(f"_{path.name}"))]
        text = next((files[key] for key in paths if key in files), path.read_text("utf-8")).encode()
    assert is_valid(schema_of(text), text)
    broken = text.replace(b"</", b"<nonsense x='1'><a></a></nonsense></", 1)
    assert not is_valid(schema_of(text), broken) or schema_of(text).name == "behaviortree.xsd"


def test_all_schemas_are_listed() -> None:
    for path in (ROOT / "schemas").iterdir():
        assert path.name == "README.md" or f"`{path.name}`" in README, path.name


def test_the_commands() -> None:
    for line in re.findall(r"^xmllint (.*)$", README, re.MULTILINE):
        *_, schema, model = shlex.split(line)
        assert is_valid(ROOT / schema, (ROOT / model).read_bytes()), line


OLD = '<scxml initial="on" version="1.0" name="Base" xmlns="...">\n<state id="on" />\n</scxml>\n'


def test_other_namespaces() -> None:
    (line,) = re.findall(r"^sed '(.*?)' .* --schema (\S+) -$", README, re.MULTILINE)
    expression, schema = line
    old, new = expression.removeprefix("s/").removesuffix("/").split("/")
    stripped = re.sub(old, new, OLD)
    assert stripped != OLD
    assert not is_valid(ROOT / schema, OLD.encode())
    assert is_valid(ROOT / schema, stripped.encode())
