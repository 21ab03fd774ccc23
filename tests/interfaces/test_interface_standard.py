# SPDX-License-Identifier: Apache-2.0
"""The shipped definitions are those of ROS 2."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

import conformance
from roaml.interfaces import KINDS, ArrayKind, Definition, FieldType, Kind, Registry, SearchPath, parse
from roaml.text import decode

STANDARD = Path(str(resources.files("roaml.interfaces"))) / "standard"


def read(path: str) -> Any:
    return decode(path, Path(path).read_bytes())


REGISTRY = Registry(SearchPath(ros_paths=[str(conformance.INTERFACES)]), read)


def shipped() -> Iterator[tuple[str, Kind, str]]:
    for package, kinds in SearchPath().packages().items():
        for kind in KINDS:
            yield from ((package, kind, name) for name in kinds[kind])


def check(file: Path) -> Definition:
    """Read a file that must have no errors, and whose nested types must all exist."""
    package, kind, name = file.parts[-3], file.parts[-2], file.stem
    definition, findings = parse(read(str(file)).text, package, name, kind)  # type: ignore[arg-type]
    assert not findings
    for section in definition.sections:
        for field in section.fields:
            if not field.type.is_primitive:
                assert isinstance(REGISTRY.resolve("msg", field.type.name), Definition), field
    return definition


@pytest.mark.parametrize("file", sorted(STANDARD.glob("*/*/*")), ids=lambda file: "/".join(file.parts[-3:]))
def test_shipped_file(file: Path) -> None:
    assert file.suffix == f".{file.parts[-2]}"
    text = file.read_text(encoding="ascii")
    assert text.endswith("\n")
    assert all(len(line) <= 120 and line == line.rstrip() for line in text.splitlines())
    assert check(file).comment


def test_shipped_files_are_found() -> None:
    assert len(list(shipped())) == len(list(STANDARD.glob("*/*/*")))


# ---------------------------------------------------------------------------------------------- compared with rosbags

Shape = tuple[list[Any], list[tuple[str, FieldType]]]

PLACEHOLDER = "structure_needs_at_least_one_member"

DIFFERENT_IN_HUMBLE = {  # more constants or fields since, or other types
    "rcl_interfaces/Log",
    "sensor_msgs/BatteryState",
    "sensor_msgs/NavSatStatus",
    "sensor_msgs/Range",
    "visualization_msgs/Marker",
}
NOT_IN_HUMBLE = {
    "geometry_msgs/PolygonInstance",
    "geometry_msgs/PolygonInstanceStamped",
    "geometry_msgs/VelocityStamped",
    "rcl_interfaces/LoggerLevel",
    "rcl_interfaces/SetLoggerLevelsResult",
    "service_msgs/ServiceEventInfo",
    "type_description_interfaces/Field",
    "type_description_interfaces/FieldType",
    "type_description_interfaces/IndividualTypeDescription",
    "type_description_interfaces/KeyValue",
    "type_description_interfaces/TypeDescription",
    "type_description_interfaces/TypeSource",
}
NOT_IN_ROSBAGS = {"example_interfaces"}


def known_to_rosbags(store: Stores) -> dict[str, Shape]:
    return {
        name.replace("/msg/", "/"): (
            [(const, type_, value) for const, type_, value in constants],
            [(field, _field_type(type_)) for field, type_ in fields if field != PLACEHOLDER],
        )
        for name, (constants, fields) in get_typestore(store).fielddefs.items()
    }


def _field_type(described: Any) -> FieldType:
    """A type as rosbags describes it: its kind and then (name, string bound), a message name or (element, size)."""
    kind, detail = described
    if kind.name == "BASE":
        return FieldType(detail[0], detail[1] or None)
    if kind.name == "NAME":
        return FieldType(detail.replace("/msg/", "/"))
    element, size = _field_type(detail[0]), detail[1]
    if kind.name == "ARRAY":
        return FieldType(element.name, element.string_bound, ArrayKind.FIXED, size)
    array = ArrayKind.BOUNDED if size else ArrayKind.UNBOUNDED
    return FieldType(element.name, element.string_bound, array, size or None)


def known_to_us() -> dict[str, Shape]:
    shapes = {}
    for package, kind, name in shipped():
        if kind == "msg" and package not in NOT_IN_ROSBAGS:
            definition = REGISTRY.message(package, name)
            assert isinstance(definition, Definition)
            (section,) = definition.sections
            constants = [(constant.name, constant.type.name, constant.value) for constant in section.constants]
            shapes[definition.full_name] = (constants, [(field.name, field.type) for field in section.fields])
    return shapes


def test_messages_are_those_of_jazzy() -> None:
    packages = {package for package, _, _ in shipped()}
    jazzy = known_to_rosbags(Stores.ROS2_JAZZY)
    assert known_to_us() == {name: shape for name, shape in jazzy.items() if name.split("/")[0] in packages}


def test_messages_are_those_of_later_distributions() -> None:
    ours, latest = known_to_us(), known_to_rosbags(Stores.LATEST)
    assert {name for name, shape in ours.items() if latest.get(name) != shape} == set()


def test_messages_are_those_of_humble_and_later_additions() -> None:
    ours, humble = known_to_us(), known_to_rosbags(Stores.ROS2_HUMBLE)
    assert ours.keys() - humble.keys() == NOT_IN_HUMBLE
    assert {name for name in ours.keys() & humble.keys() if ours[name] != humble[name]} == DIFFERENT_IN_HUMBLE
    for name in NOT_IN_HUMBLE | DIFFERENT_IN_HUMBLE:
        definition = REGISTRY.resolve("msg", name)
        assert isinstance(definition, Definition)
        assert "Humble" in Path(definition.path).read_text(encoding="ascii")


def test_defaults() -> None:
    """Defaults, which rosbags does not provide."""
    defaults = {
        f"{package}/{name}.{field.name}": field.default
        for package, kind, name in shipped()
        for section in _sections(kind, package, name)
        for field in section.fields
        if field.default is not None
    }
    assert defaults == {
        "geometry_msgs/Quaternion.x": 0.0,
        "geometry_msgs/Quaternion.y": 0.0,
        "geometry_msgs/Quaternion.z": 0.0,
        "geometry_msgs/Quaternion.w": 1.0,
        "rcl_interfaces/ParameterDescriptor.read_only": False,
        "rcl_interfaces/ParameterDescriptor.dynamic_typing": False,
        "type_description_interfaces/GetTypeDescription.include_type_sources": True,
    }


def _sections(kind: Kind, package: str, name: str) -> Any:
    definition = REGISTRY.find(kind, package, name)
    assert isinstance(definition, Definition)
    return definition.sections


# ------------------------------------------------------------------------- services and actions: not known to rosbags

SERVICES = {
    "action_msgs": "CancelGoal",
    "composition_interfaces": "ListNodes LoadNode UnloadNode",
    "diagnostic_msgs": "AddDiagnostics SelfTest",
    "example_interfaces": "AddTwoInts SetBool Trigger",
    "lifecycle_msgs": "ChangeState GetAvailableStates GetAvailableTransitions GetState",
    "nav_msgs": "GetMap GetPlan LoadMap SetMap",
    "rcl_interfaces": "DescribeParameters GetLoggerLevels GetParameterTypes GetParameters ListParameters "
    "SetLoggerLevels SetParameters SetParametersAtomically",
    "sensor_msgs": "SetCameraInfo",
    "std_srvs": "Empty SetBool Trigger",
    "tf2_msgs": "FrameGraph",
    "type_description_interfaces": "GetTypeDescription",
    "visualization_msgs": "GetInteractiveMarkers",
}
ACTIONS = {"example_interfaces": "Fibonacci", "tf2_msgs": "LookupTransform"}


def test_services_and_actions() -> None:
    packages = SearchPath().packages()
    for kind, expected in (("srv", SERVICES), ("action", ACTIONS)):
        assert {name: " ".join(kinds[kind]) for name, kinds in packages.items() if kinds[kind]} == expected  # type: ignore[index]


SIGNATURES: list[tuple[Kind, str, str]] = [
    ("srv", "example_interfaces/AddTwoInts", "int64 a, int64 b -> int64 sum"),
    ("srv", "std_srvs/Empty", " -> "),
    ("srv", "std_srvs/SetBool", "bool data -> bool success, string message"),
    ("srv", "std_srvs/Trigger", " -> bool success, string message"),
    ("action", "example_interfaces/Fibonacci", "int32 order -> int32[] sequence -> int32[] sequence"),
    ("msg", "example_interfaces/String", "string data"),
    ("msg", "geometry_msgs/Pose2D", "float64 x, float64 y, float64 theta"),
]


@pytest.mark.parametrize(("kind", "name", "signature"), SIGNATURES)
def test_signatures(kind: Kind, name: str, signature: str) -> None:
    sections = _sections(kind, *name.split("/"))
    assert " -> ".join(", ".join(f"{f.type} {f.name}" for f in section.fields) for section in sections) == signature


def test_results_of_goals() -> None:
    """The codes that models compare with, docs/spec/ros.md#action-client."""
    status = REGISTRY.message("action_msgs", "GoalStatus")
    assert isinstance(status, Definition)
    codes = {constant.name: constant.value for constant in status.sections[0].constants}
    assert (codes["STATUS_SUCCEEDED"], codes["STATUS_CANCELED"], codes["STATUS_ABORTED"]) == (4, 5, 6)
