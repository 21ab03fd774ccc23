# SPDX-License-Identifier: Apache-2.0
"""Versions of BehaviorTree.CPP 4, and what changed between them (docs/spec/lone-trees.md#versions)."""

from __future__ import annotations

import re
from typing import NamedTuple

from roaml.regex import regex

_LATEST = 999
"""The number that represents the latest patch of a minor version, or the latest minor version."""

_TEXT = regex(r"4\.([0-9]{1,3})(?:\.([0-9]{1,3}))?\Z", re.ASCII)


class Version(NamedTuple):
    """A version of BehaviorTree.CPP. Versions are ordered."""

    major: int
    minor: int
    patch: int = _LATEST


NEWEST_VERSION = Version(4, _LATEST)
"""The newest version, which is used unless the user names another one."""


def read_version(text: str) -> Version | None:
    """The version that a text such as `4.6` or `4.8.2` names. Without the third number, it is the latest patch of the
    minor version. `None` if the text does not name a version of BehaviorTree.CPP 4."""
    match = _TEXT.match(text)
    if match is None:
        return None
    return Version(4, int(match[1]), _LATEST if match[2] is None else int(match[2]))


def first_patch(text: str) -> Version:
    """The first patch of a version such as `4.7` or `4`."""
    major, _, minor = text.partition(".")
    return Version(int(major), int(minor or 0), 0)


TAGS_LOOKED_UP_SINCE = Version(4, 7, 0)
"""The tags of the children of a `ReactiveSequence` are looked up as names of nodes."""
ASYNC_SEQUENCES_REFUSED_SINCE = Version(4, 7, 0)
"""A `ReactiveSequence` cannot have two children `AsyncSequence`."""
NAMES_CHECKED_SINCE = Version(4, 8, 4)
"""Names cannot contain certain characters, and two `SubTree` of one tree need different names."""
SCRIPTS_CHANGED_SINCE = Version(4, 9, 0)
"""The operators of scripts have other precedences."""
CONSTANTS_TYPED_SINCE = Version(4, 9, 1)
"""A number that a `SubTree` gives to an entry is stored as a number, not as a text."""
CASES_WHOLE_SINCE = Version(4, 10, 0)
"""A case of a `Switch` is a number only if all of its text is one."""
