# SPDX-License-Identifier: Apache-2.0
"""Names -> definitions, or the reason why there are none."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml.interfaces import Definition, Kind, NotFound, Parsed, Reason, Registry, SearchPath, split_type_name
from roaml.text import SourceFile, decode


class Files:
    """The disk below an editor's open files; remembers what was read."""

    def __init__(self) -> None:
        self.open: dict[str, str] = {}
        self.read_paths: list[str] = []

    def read(self, path: str) -> SourceFile | None:
        self.read_paths.append(path)
        if path in self.open:
            return SourceFile(path, self.open[path])
        try:
            return decode(path, Path(path).read_bytes())
        except OSError:
            return None


@pytest.fixture
def files() -> Files:
    return Files()


@pytest.fixture
def registry(tmp_path: Path, files: Files) -> Registry:
    for name, text in {
        "msg/Place.msg": "# Where.\n\nfloat64 x\ngeometry_msgs/Point[] way\nOther other\n",
        "msg/Other.msg": "int33 a\n",
        "srv/Ask.srv": "string question\n---\nstring answer\n",
        "action/Go.action": "Place place\n---\n---\nfloat32 left\n",
    }.items():
        path = tmp_path / "my_msgs" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return Registry(SearchPath([str(tmp_path)]), files.read)


def test_definitions(tmp_path: Path, registry: Registry) -> None:
    place = registry.message("my_msgs", "Place")
    assert isinstance(place, Definition)
    assert (place.full_name, place.kind, place.comment) == ("my_msgs/Place", "msg", "Where.")
    assert place.path == str(tmp_path / "my_msgs" / "msg" / "Place.msg")
    assert [str(field.type) for field in place.sections[0].fields] == [
        "float64",
        "geometry_msgs/Point[]",
        "my_msgs/Other",
    ]
    ask, go = registry.service("my_msgs", "Ask"), registry.action("my_msgs", "Go")
    assert isinstance(ask, Definition)
    assert isinstance(go, Definition)
    assert ask.section("response").fields[0].name == "answer"
    assert go.section("feedback").fields[0].name == "left"
    for field in place.sections[0].fields[1:]:
        assert isinstance(registry.resolve("msg", field.type.name), Definition)


def test_standard_packages_are_there(registry: Registry) -> None:
    for kind, name in (
        ("msg", "std_msgs/Int32"),
        ("srv", "std_srvs/SetBool"),
        ("action", "example_interfaces/Fibonacci"),
    ):
        assert isinstance(registry.resolve(kind, name), Definition)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "kind", "names"),
    [
        ("std_msgs/Int32", "msg", ("std_msgs", "Int32")),
        ("std_msgs/msg/Int32", "msg", ("std_msgs", "Int32")),
        ("std_srvs/srv/Empty", "srv", ("std_srvs", "Empty")),
        ("std_srvs/srv/Empty", "msg", None),
        ("Int32", "msg", None),
        ("", "msg", None),
        ("/", "msg", None),
        ("std_msgs/", "msg", None),
        ("/Int32", "msg", None),
        ("std_msgs/int32", "msg", None),
        ("Std_msgs/Int32", "msg", None),
        ("std_msgs/Int32 ", "msg", None),
        ("std_msgs/Int32[]", "msg", None),
        ("a/msg/msg/B", "msg", None),
    ],
)
def test_type_names(text: str, kind: Kind, names: tuple[str, str] | None) -> None:
    assert split_type_name(text, kind) == names


def test_a_file_is_parsed_once(registry: Registry) -> None:
    first = registry.message("my_msgs", "Place")
    assert registry.message("my_msgs", "Place") is first
    assert registry.resolve("msg", "my_msgs/msg/Place") is first


def test_open_files_go_before_the_disk(tmp_path: Path, registry: Registry, files: Files) -> None:
    path = str(tmp_path / "my_msgs" / "msg" / "Place.msg")
    before = registry.message("my_msgs", "Place")
    files.open[path] = "bool changed\n"
    after = registry.message("my_msgs", "Place")
    assert isinstance(after, Definition)
    assert [field.name for field in after.sections[0].fields] == ["changed"]
    files.open[path] = "# only a comment more\nbool changed # so\n"
    again = registry.message("my_msgs", "Place")
    assert again == after
    assert again is not after
    del files.open[path]
    assert registry.message("my_msgs", "Place") == before


def test_a_type_that_moves_is_read_where_it_is(tmp_path: Path, registry: Registry) -> None:
    (tmp_path / "std_msgs" / "msg").mkdir(parents=True)
    own = tmp_path / "std_msgs" / "msg" / "Int32.msg"
    own.write_text("string data\n")
    messages = [registry.message("std_msgs", "Int32")]
    own.unlink()
    registry.search_path.refresh()
    messages.append(registry.message("std_msgs", "Int32"))
    types = [d.sections[0].fields[0].type.name for d in messages if isinstance(d, Definition)]
    assert types == ["string", "int32"]


def test_mistakes_of_a_file(registry: Registry) -> None:
    other = registry.parsed("msg", "my_msgs", "Other")
    assert isinstance(other, Parsed)
    assert [finding.message for finding in other.findings] == ["there is no type `int33`; did you mean `int32`?"]
    assert registry.message("my_msgs", "Other") is other.definition


def test_only_what_is_asked_for_is_read(tmp_path: Path, registry: Registry, files: Files) -> None:
    registry.message("my_msgs", "Place")
    registry.message("my_msgs", "Plaice")
    assert files.read_paths == [str(tmp_path / "my_msgs" / "msg" / "Place.msg")]


NOT_FOUND = [
    ("msg", "std_msg/Int32", Reason.UNKNOWN_PACKAGE, "there is no package `std_msg`; did you mean `std_msgs/Int32`"),
    ("msg", "std_msg/Int3", Reason.UNKNOWN_PACKAGE, "there is no package `std_msg`; did you mean `std_msgs/Int32`"),
    (
        "msg",
        "geometry/Twist",
        Reason.UNKNOWN_PACKAGE,
        "there is no package `geometry`; did you mean `geometry_msgs/Twist`?",
    ),
    ("msg", "his_own/Thing", Reason.UNKNOWN_PACKAGE, "there is no package `his_own`; searched the workspace `/"),
    (
        "msg",
        "std_msgs/Int33",
        Reason.UNKNOWN_TYPE,
        "the package `std_msgs` has no message `Int33`; did you mean `std_msgs/",
    ),
    (
        "msg",
        "std_msgs/Twist",
        Reason.UNKNOWN_TYPE,
        "the package `std_msgs` has no message `Twist`; did you mean `geometry_msgs/Twist`",
    ),
    ("action", "my_msgs/Run", Reason.UNKNOWN_TYPE, "the package `my_msgs` has no action `Run`"),
    ("msg", "std_srvs/SetBool", Reason.UNKNOWN_TYPE, "`std_srvs/SetBool` is a service, not a message"),
    ("srv", "my_msgs/Go", Reason.UNKNOWN_TYPE, "`my_msgs/Go` is an action, not a service"),
    ("action", "my_msgs/Ask", Reason.UNKNOWN_TYPE, "`my_msgs/Ask` is a service, not an action"),
    (
        "msg",
        "Int32",
        Reason.MALFORMED_NAME,
        "`Int32` is not the name of a message type of the form `package/Name`; did you mean `example_int",
    ),
    (
        "msg",
        "std_msgs.msg.Int32",
        Reason.MALFORMED_NAME,
        "`std_msgs.msg.Int32` is not the name of a message type of the form `package/Name`; did you mean `std_msgs/Int",
    ),
    (
        "msg",
        "std_msgs::msg::Bool",
        Reason.MALFORMED_NAME,
        "`std_msgs::msg::Bool` is not the name of a message type of the form `package/Name`; did you mean `std_msgs/Bo",
    ),
    (
        "srv",
        "std_srvs/empty",
        Reason.MALFORMED_NAME,
        "`std_srvs/empty` is not the name of a service type of the form `package/Name`; did you mean `std_srvs/Empty`?",
    ),
    ("msg", "", Reason.MALFORMED_NAME, "`` is not the name of a message type of the form `package/Name`"),
    ("msg", "../../etc/passwd", Reason.MALFORMED_NAME, "`../../etc/passwd` is not the name of a message type"),
]


@pytest.mark.parametrize(("kind", "name", "reason", "beginning"), NOT_FOUND)
def test_not_found(registry: Registry, kind: Kind, name: str, reason: Reason, beginning: str) -> None:
    answer = registry.resolve(kind, name)
    assert isinstance(answer, NotFound)
    assert (answer.reason, answer.kind, answer.type_name) == (reason, kind, name)
    assert answer.message.startswith(beginning)
    assert answer.looked_in[-1] == "the standard packages included in this tool"
    for close in answer.close:
        assert isinstance(registry.resolve(kind, close), Definition)


def test_malformed_parts(registry: Registry) -> None:
    answer = registry.message("std_msgs/msg", "Int32")
    assert isinstance(answer, NotFound)
    assert answer.reason is Reason.MALFORMED_NAME
    assert answer.close[0] == "std_msgs/Int32"


def test_a_file_that_went(tmp_path: Path, registry: Registry) -> None:
    registry.search_path.packages()
    path = tmp_path / "my_msgs" / "msg" / "Place.msg"
    path.unlink()
    answer = registry.message("my_msgs", "Place")
    assert isinstance(answer, NotFound)
    assert (answer.reason, answer.path) == (Reason.UNREADABLE, str(path))
    assert answer.message == f"the file `{path}`, which defines `my_msgs/Place`, cannot be read"
