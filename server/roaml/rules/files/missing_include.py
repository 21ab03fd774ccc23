# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-include`, which missing_include.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext


def check(context: TreeContext) -> Iterator[Finding]:
    for include in context.file.includes:
        if include.path is not None and include.path.value in context.missing_includes:
            reason = context.missing_includes[include.path.value]
            yield RULE.at(include.path.span, f"`{include.path.value}` cannot be included: {reason}")
        elif include.path is not None and include.path.value in context.found_includes:
            found = context.found_includes[include.path.value]
            message = f"there is no file `{include.path.value}` in the sources; `{found}` is read instead"
            yield RULE.at(include.path.span, message, severity=Severity.INFORMATION)
        elif include.package is not None and include.package.value in context.unknown_packages:
            message = (
                f"no folder around this file contains the ROS package `{include.package.value}`, "
                "so the trees and models in it are unknown"
            )
            yield RULE.at(include.package.span, message, severity=Severity.INFORMATION)


RULE = Rule("missing-include", Severity.ERROR, "A tree file includes a file that cannot be included.", tree=check)
