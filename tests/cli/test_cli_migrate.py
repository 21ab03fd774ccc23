# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp migrate`: older systems become current ones, and nothing else changes (docs/spec/files.md#dialects)."""

from __future__ import annotations

import os
import stat
import subprocess
from pathlib import Path

import pytest
from command import Command

import as2fm_lsp.cli.migrate
import clock
from fixture import split_files

OLD = split_files(
    """\
-- main.xml --
<?xml version="1.0" encoding="UTF-8"?>
<!-- The robot of the paper. -->
<convince_mc_tc xmlns="...">
    <!-- how long  -->
    <mc_parameters>
        <max_time value="100"   unit="s" />
    </mc_parameters>

    <behavior_tree>
        <input type="bt.cpp-xml"   src="./bt.xml" />
        <input type="bt-plugin-ros-scxml" src="plugins/move&amp;wait.scxml" id="move" /> <!-- moves -->
    </behavior_tree>
    <node_models>
        <input type='ros-scxml'
               src='nodes/base.scxml' id="base"/>
    </node_models>
    <properties><input type="jani" src="p.jani" /></properties>
</convince_mc_tc>
<!-- the end -->
-- bt.xml --
<root BTCPP_format="4"><BehaviorTree ID="Main"><Action ID="Move" name="mv" /></BehaviorTree></root>
-- plugins/move&wait.scxml --
<?xml version="1.0" encoding="UTF-8"?>
<!-- keep me: é 字 🤖 &amp; &#65; -->
<scxml   initial="idle" version="1.0" name="Move" model_src=""
         xmlns="http://www.w3.org/2005/07/scxml">

    <ros_topic_publisher topic="/cmd" type="geometry_msgs/Vector3" />  <!-- no name -->
    <state id="idle">

        <bt_tick target="idle">
            <log label="x" expr="'tick'" />
            <ros_topic_publish name="/cmd">
                <field name="x" expr="1.0"/>   <!-- ahead -->
            </ros_topic_publish>
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="idle"><log expr="'halt'" /><bt_return_halted /></bt_halt>
    </state>
</scxml>
-- nodes/base.scxml --
<scxml initial="on" version="1.0" name="Base" xmlns="...">
    <datamodel><data id="v" expr="0.0" type="float64"/></datamodel>
    <ros_topic_subscriber topic="/cmd" type="geometry_msgs/Vector3" />
    <state id="on">
        <ros_topic_callback name="/cmd" target="on"><assign location="v" expr="_msg.x" /></ros_topic_callback>
    </state>
</scxml>
-- p.jani --
{"properties": []}
"""
)

NEW = split_files(
    """\
-- main.xml --
<?xml version="1.0" encoding="UTF-8"?>
<!-- The robot of the paper. -->
<roaml>
    <!-- how long  -->
    <parameters>
        <max_time value="100"   unit="s" />
    </parameters>

    <behavior_tree>
        <input type="bt.cpp-xml"   src="./bt.xml" />
        <input type="bt-plugin-ascxml" src="plugins/move&amp;wait.ascxml" id="move" /> <!-- moves -->
    </behavior_tree>
    <node_models>
        <input type='node-ascxml'
               src='nodes/base.ascxml' id="base"/>
    </node_models>
    <properties><input type="jani" src="p.jani" /></properties>
</roaml>
<!-- the end -->
-- bt.xml --
<root BTCPP_format="4"><BehaviorTree ID="Main"><Action ID="Move" name="mv" /></BehaviorTree></root>
-- plugins/move&wait.ascxml --
<?xml version="1.0" encoding="UTF-8"?>
<!-- keep me: é 字 🤖 &amp; &#65; -->
<ascxml   initial="idle" version="1.0" name="Move" model_src=""
         xmlns="http://www.w3.org/2005/07/scxml">

    <ros_topic_publisher topic="/cmd" type="geometry_msgs/Vector3" />  <!-- no name -->
    <state id="idle">

        <bt_tick target="idle">
            <ros_topic_publish name="/cmd">
                <field name="x" expr="1.0"/>
                <field name="y" expr="0.0" />
                <field name="z" expr="0.0" />   <!-- ahead -->
            </ros_topic_publish>
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="idle"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- nodes/base.ascxml --
<ascxml initial="on" version="1.0" name="Base" xmlns="http://www.w3.org/2005/07/scxml">
    <datamodel><data id="v" expr="0.0" type="float64"/></datamodel>
    <ros_topic_subscriber topic="/cmd" type="geometry_msgs/Vector3" />
    <state id="on">
        <ros_topic_callback name="/cmd" target="on"><assign location="v" expr="_msg.x" /></ros_topic_callback>
    </state>
</ascxml>
-- p.jani --
{"properties": []}
"""
)

DEPRECATED = {"deprecated-spelling", "foreign-namespace", "ignored-element", "missing-field"}


def write(folder: Path, files: dict[str, str] = OLD, encoding: str = "utf-8") -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode(encoding))


def read(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def encoded(files: dict[str, str]) -> dict[str, bytes]:
    return {name: text.encode() for name, text in files.items()}


def test_an_older_system_becomes_a_current_one(command: Command, check: Command, tmp_path: Path) -> None:
    write(tmp_path)
    before = check("main.xml")
    assert before.status == 0
    assert set(before.codes) >= DEPRECATED
    done = command("migrate", "main.xml")
    assert (done.status, done.err) == (0, "")
    assert done.out == (
        "migrated main.xml\n"
        "migrated plugins/move&wait.scxml -> plugins/move&wait.ascxml\n"
        "migrated nodes/base.scxml -> nodes/base.ascxml\n"
    )
    assert read(tmp_path) == encoded(NEW)
    after = check("main.xml")
    assert after.status == 0
    assert not DEPRECATED & set(after.codes)


def test_a_second_migration_changes_nothing(command: Command, tmp_path: Path) -> None:
    write(tmp_path)
    command("migrate", ".")
    before = read(tmp_path)
    assert command("migrate", ".") == (0, "nothing to migrate\n", "")
    assert command("migrate", ".", "--diff") == (0, "", "")
    assert read(tmp_path) == before


def test_diff_writes_nothing_and_is_a_patch(command: Command, tmp_path: Path) -> None:
    write(tmp_path)
    before = read(tmp_path)
    done = command("migrate", "main.xml", "--diff")
    assert (done.status, done.err) == (1, "")
    assert read(tmp_path) == before
    assert [line for line in done.out.splitlines() if line.startswith(("--- ", "+++ "))] == [
        "--- main.xml",
        "+++ main.xml",
        "--- plugins/move&wait.scxml",
        "+++ plugins/move&wait.ascxml",
        "--- nodes/base.scxml",
        "+++ nodes/base.ascxml",
    ]
    patched = tmp_path / "patched"
    write(patched, {new: OLD[old] for old, new in zip(OLD, NEW, strict=True)})
    patch = done.out.replace(".scxml\n+++", ".ascxml\n+++")
    subprocess.run(["git", "apply", "-p0"], input=patch, cwd=patched, text=True, check=True)
    assert read(patched) == encoded(NEW)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
def test_line_ends_stay(command: Command, tmp_path: Path, end: str) -> None:
    write(tmp_path, {name: text.replace("\n", end) for name, text in OLD.items()})
    assert command("migrate", ".").status == 0
    assert read(tmp_path) == encoded({name: text.replace("\n", end) for name, text in NEW.items()})


@pytest.mark.parametrize("mark", [b"\xef\xbb\xbf", b""], ids=["BOM", "no BOM"])
def test_a_byte_order_mark_stays(command: Command, tmp_path: Path, mark: bytes) -> None:
    write(tmp_path)
    for name, data in read(tmp_path).items():
        if name.endswith("xml"):
            (tmp_path / name).write_bytes(mark + data)
    assert command("migrate", ".").status == 0
    assert read(tmp_path) == {
        name: (mark if name.endswith("xml") else b"") + text.encode() for name, text in NEW.items()
    }


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16", "windows-1252"])
def test_the_encoding_stays(command: Command, check: Command, tmp_path: Path, encoding: str) -> None:
    write(tmp_path)
    path = "nodes/base.scxml"
    declaration = f'<?xml version="1.0" encoding="{encoding}"?>\n<!-- Größe -->\n'
    (tmp_path / path).write_bytes((declaration + OLD[path]).encode(encoding))
    assert command("migrate", ".").status == 0
    new = "nodes/base.ascxml"
    assert (tmp_path / new).read_bytes() == (declaration + NEW[new]).encode(encoding)
    assert not DEPRECATED & set(check(".").codes)


def test_a_file_with_invalid_utf8_is_not_changed(command: Command, tmp_path: Path) -> None:
    write(tmp_path)
    path = tmp_path / "nodes/base.scxml"
    path.write_bytes(path.read_bytes().replace(b"</scxml>", b"<!-- caf\xe9 --></scxml>"))
    before = read(tmp_path)
    done = command("migrate", ".")
    assert done.status == 2
    assert done.err == f"as2fm-lsp: {path}: not valid UTF-8; fix the encoding\n"
    assert read(tmp_path) == before


def test_modes_stay(command: Command, tmp_path: Path) -> None:
    write(tmp_path)
    (tmp_path / "nodes/base.scxml").chmod(0o640)
    (tmp_path / "main.xml").chmod(0o600)
    command("migrate", ".")
    assert stat.S_IMODE((tmp_path / "nodes/base.ascxml").stat().st_mode) == 0o640
    assert stat.S_IMODE((tmp_path / "main.xml").stat().st_mode) == 0o600


def test_ignored_findings_are_migrated_too(command: Command, tmp_path: Path) -> None:
    write(tmp_path)
    (tmp_path / "as2fm.toml").write_text('select = ["unknown-element"]\nignore = ["deprecated-spelling"]\n')
    command("migrate", ".")
    (tmp_path / "as2fm.toml").unlink()
    assert read(tmp_path) == encoded(NEW)


def test_a_file_is_never_overwritten(command: Command, tmp_path: Path) -> None:
    write(tmp_path)
    (tmp_path / "nodes/base.ascxml").write_text("mine")
    before = read(tmp_path)
    done = command("migrate", ".")
    assert done.status == 2
    assert done.err.endswith("base.ascxml already exists; nothing was changed\n")
    assert read(tmp_path) == before


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("is_repository", [True, False])
def test_a_machine_of_a_further_system_is_not_taken_away_from_it(
    command: Command, tmp_path: Path, named: bool, is_repository: bool
) -> None:
    write(tmp_path / "a")
    if is_repository:
        (tmp_path / ".git").mkdir()
    else:  # the files of a system show where others may be
        (tmp_path / "common").mkdir()
        (tmp_path / "common/bt.xml").write_text(OLD["bt.xml"])
        (tmp_path / "a/main.xml").write_text(OLD["main.xml"].replace("./bt.xml", "../common/bt.xml"))
    other = tmp_path / "b" / "main.xml"
    other.parent.mkdir()
    other.write_text(OLD["main.xml"].replace('src="', 'src="../a/').replace("src='", "src='../a/"))
    before = read(tmp_path)
    done = command("migrate", "a/main.xml")
    assert done.status == 2
    assert done.err.endswith(
        "would change, which breaks b/main.xml; nothing was changed; add --with-related to migrate b/main.xml, too\n"
    )
    assert read(tmp_path) == before
    assert command("migrate", "a/main.xml", *("b/main.xml" if named else "--with-related",)).status == 0
    assert other.read_text() == NEW["main.xml"].replace('src="', 'src="../a/').replace("src='", "src='../a/")
    assert command("--check", ".").status == 0


def test_systems_that_share_files_with_each_other_come_along(command: Command, check: Command, tmp_path: Path) -> None:
    """A shares a machine with B, and B another one with C; D shares none."""
    (tmp_path / ".git").mkdir()
    for name, machines in {"a": "x", "b": "xy", "c": "y", "d": "z"}.items():
        inputs = "".join(f'<input type="ros-scxml" src="{machine}.scxml" />' for machine in machines)
        (tmp_path / f"{name}.xml").write_text(
            '<convince_mc_tc><mc_parameters><max_time value="1" unit="s" /></mc_parameters>'
            f'<node_models>{inputs}</node_models><properties><input type="jani" src="p.jani" /></properties>'
            "</convince_mc_tc>"
        )
        for machine in machines:
            (tmp_path / f"{machine}.scxml").write_text(OLD["nodes/base.scxml"].replace("Base", f"M{machine}"))
    (tmp_path / "p.jani").write_text(OLD["p.jani"])
    before = read(tmp_path)
    done = command("migrate", "a.xml")
    assert (done.status, read(tmp_path)) == (2, before)
    assert "breaks b.xml; nothing was changed; add --with-related" in done.err
    assert command("migrate", "a.xml", "--with-related").status == 0
    assert sorted(path.name for path in tmp_path.glob("*.*scxml")) == ["x.ascxml", "y.ascxml", "z.scxml"]
    after = read(tmp_path)
    assert after["d.xml"] == before["d.xml"]
    assert [name for name in "abc" if b"<roaml>" in after[f"{name}.xml"]] == ["a", "b", "c"]
    assert not [row for row in check("a.xml", "b.xml", "c.xml").rows if row["code"] == "missing-file"]


def test_a_file_that_is_shared_and_keeps_its_name_does_not_stop_it(command: Command, tmp_path: Path) -> None:
    write(tmp_path / "a")
    (tmp_path / ".git").mkdir()
    (tmp_path / "b.xml").write_text(
        '<roaml><behavior_tree><input type="bt.cpp-xml" src="a/bt.xml" /></behavior_tree></roaml>'
    )
    assert command("migrate", "a").status == 0


def test_when_writing_fails_each_system_names_files_that_are_there(
    command: Command, check: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path)
    real = as2fm_lsp.cli.migrate.write_file
    for failing in ("main.xml", "move&wait.ascxml", "base.ascxml"):

        def write_file(path: str, content: bytes, failing: str = failing) -> None:
            if os.path.basename(path) == failing:
                raise OSError(28, "No space left on device", path)
            real(path, content)

        monkeypatch.setattr(as2fm_lsp.cli.migrate, "write_file", write_file)
        done = command("migrate", "main.xml")
        assert (done.status, done.out) == (2, "")
        assert done.err.endswith(f"{failing}: No space left on device\n")
        assert check("main.xml").status == 0
        for path in tmp_path.rglob("*.ascxml"):
            path.unlink()


def test_current_systems_are_left_alone(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    assert command("migrate", ".") == (0, "nothing to migrate\n", "")


def test_a_current_system_with_older_machines(command: Command, check: Command, tmp_path: Path) -> None:
    older = clock.CLOCK.replace("ascxml", "scxml")
    clock.write(tmp_path, main=clock.MAIN.replace("clock.ascxml", "clock.scxml"))
    (tmp_path / "clock.ascxml").unlink()
    (tmp_path / "clock.scxml").write_text(older)
    assert check(".").status == 1
    assert command("migrate", ".").status == 0
    assert check(".").status == 0
    assert read(tmp_path) == encoded(clock.FILES)


def test_events_of_the_tree(command: Command, check: Command, tmp_path: Path) -> None:
    """Tree events, which are removed (docs/spec/files.md#removed-tree-events)."""
    files = dict(NEW)
    plugin = "plugins/move&wait.ascxml"
    now = files[plugin]
    files[plugin] = (
        now.replace('<bt_tick target="idle">', '<transition event="bt_tick" target="idle">')
        .replace("</bt_tick>", "</transition>")
        .replace('<bt_return_status status="SUCCESS" />', '<send event="bt_success" />')
    )
    write(tmp_path, files)
    assert check(".").status == 1
    assert command("migrate", ".").status == 0
    assert check(".").status == 0
    assert (tmp_path / plugin).read_text().replace("bt_tick  ", "bt_tick ") == now


@pytest.mark.parametrize("name", ["plugins/move&wait.scxml", "p.jani"])
def test_only_systems_and_trees_are_migrated(command: Command, tmp_path: Path, name: str) -> None:
    write(tmp_path)
    done = command("migrate", name)
    assert done.status == 2
    assert done.err.endswith("neither a system file nor a tree; name one of these\n")
    assert read(tmp_path) == encoded(OLD)


def test_a_folder_without_systems(command: Command, tmp_path: Path) -> None:
    assert command("migrate", ".") == (0, "nothing to migrate\n", "")


def test_a_broken_system_does_not_stop_it(command: Command, tmp_path: Path) -> None:
    files = dict(OLD)
    files["nodes/base.scxml"] = OLD["nodes/base.scxml"].replace("</state>", "")
    files["main.xml"] = OLD["main.xml"].replace("p.jani", "missing.jani")
    write(tmp_path, files)
    assert command("migrate", ".").status == 0
    after = read(tmp_path)
    assert after["main.xml"] == NEW["main.xml"].replace("p.jani", "missing.jani").encode()
    assert after["nodes/base.ascxml"] == NEW["nodes/base.ascxml"].replace("</state>", "").encode()
