# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-interface`, which repeated_interface.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.ros import RepeatedType
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    """Report each package of which there are two different copies, once, where the machine first uses it."""
    reported: set[str] = set()
    for declaration in context.machine.declarations:
        for repeated in context.repeated_types:
            type_ = declaration.type
            if type_ is not None and type_.value == repeated.used_by and repeated.package not in reported:
                reported.add(repeated.package)
                message = f"there are two copies of the package `{repeated.package}`, and `{repeated.name}` differs: "
                message += (
                    f"{_folder(repeated, repeated.path)} is used, {_folder(repeated, repeated.other)} is ignored; "
                )
                message += "remove one of them, or exclude it from the folders that are searched for packages"
                yield RULE.at(type_.span, message)


def _folder(repeated: RepeatedType, path: str) -> str:
    """The folder of the package that contains a definition file: `PACKAGE/msg/Name.msg`."""
    folder = path.replace("\\", "/").rsplit("/", 2)[0]
    return f"`{folder}`"


RULE = Rule(
    "repeated-interface",
    Severity.WARNING,
    "There are two copies of a package of ROS interfaces, with different content.",
    machine=check,
)
