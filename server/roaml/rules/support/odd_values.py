# SPDX-License-Identifier: Apache-2.0
"""Values in system files and property files whose number contradicts another one of the same element, which
inconsistent-value reports. Rules that would report a consequence of them at the same place do not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.model.property_file import Port
from roaml.model.property_links import LinkedFile
from roaml.model.series import Alike, KeyedText, OddNumber, odd_numbers
from roaml.model.syntax import name_of
from roaml.model.system_file import ListedFile
from roaml.xml_syntax import Element


def odd_inputs(files: Iterable[ListedFile]) -> Iterator[OddNumber]:
    """The odd numbers in the `src` and `id` of the files that a system lists."""
    return odd_numbers(_input(file.input.element) for file in files)


def odd_ports(file: LinkedFile) -> Iterator[OddNumber]:
    """The odd numbers in the names of ports and in the ids of their variables."""
    return odd_numbers(map(_port, file.file.ports))


def _input(element: Element) -> Alike:
    texts = ((key, name_of(element.get(key))) for key in ("src", "id"))
    return Alike((), tuple(KeyedText(key, text) for key, text in texts if text is not None))


def _port(port: Port) -> Alike:
    texts = [("name", port.name), *(("id", variable.id) for variable in port.variables)]
    return Alike((port.kind.value,), tuple(KeyedText(key, name) for key, name in texts if name is not None))
