# SPDX-License-Identifier: Apache-2.0
"""`as2fm.showFirstError`: systems with errors are neither translated nor verified; lenses state that, and show the
first error when they are clicked.

The client shows the place if it supports that (`window/showDocument`); a message names it in any case.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import RequestedDocument
from roaml.diagnostics import Diagnostic
from roaml.ide.system_names import system_names
from roaml.ide.verifiable import verifiable
from roaml.project.paths import is_on_disk
from roaml.project.workspace import Snapshot

COMMAND = "as2fm.showFirstError"


def register(context: Context) -> None:
    session = context.session

    @context.command(COMMAND, needs_trust=False)
    async def show_first_error(*arguments: object) -> types.Location | None:
        """Show the first error of a system, in any of its files.

        Args:
            arguments: the URI of the system file.

        Returns:
            The place; null if the system no longer has errors.
        """
        if len(arguments) != 1 or not isinstance(arguments[0], str):
            text = f"{COMMAND} needs the URI of a system file."
            context.client.show_message(types.MessageType.Error, text)
            return None
        system = session.convert.path(arguments[0])
        snapshot = session.moment().snapshot(system)
        errors = snapshot.checker.errors(system)
        place = await show(context, snapshot, errors) if errors else None
        if place is not None:
            where = f"{os.path.basename(errors[0].path)}:{place.range.start.line + 1}"
            text = f"{where}: {errors[0].message}"
            context.client.show_message(types.MessageType.Error, text)
        return place


async def show(context: Context, snapshot: Snapshot, errors: Sequence[Diagnostic]) -> types.Location | None:
    """Let the client show the place of the first error, if it supports that. Return the place; `None` if its file does
    not exist."""
    source = snapshot.analysis.source(errors[0].path)
    if source is None:
        return None
    convert = context.session.convert
    place = types.Location(convert.uri(errors[0].path), convert.range(source, errors[0].span))
    await context.client.show_document(place)
    return place


def counted(errors: tuple[Diagnostic, ...]) -> str:
    return "1 error" if len(errors) == 1 else f"{len(errors)} errors"


def errors_of(on: RequestedDocument) -> dict[str, tuple[Diagnostic, ...]]:
    """The systems of a file that have errors, with the errors."""
    systems = on.analysis.memberships.get(on.path, ())
    errors_in = {system: on.snapshot.checker.errors(system) for system in systems if is_on_disk(system)}
    return {system: errors for system, errors in errors_in.items() if errors}


def lenses(on: RequestedDocument, broken: Mapping[str, tuple[Diagnostic, ...]]) -> Iterator[types.CodeLens]:
    """Lenses for a system file that has errors, and for the properties of systems that have errors."""
    names = system_names(on.analysis.memberships.get(on.path, ()))
    for system, errors in broken.items():
        arguments = [on.convert.uri(system)]
        file = on.analysis.system_file(system)
        if system == on.path and file is not None:
            title = f"{counted(errors)}: cannot be translated or verified"
            yield types.CodeLens(on.range(file.element.name_span), types.Command(title, COMMAND, arguments=arguments))
            continue
        properties = (p for p in verifiable(on.analysis, system) if p.path == on.path)
        for place in dict.fromkeys(property_.name_span for property_ in properties):
            title = f"{counted(errors)} in {names[system]}: cannot be verified"
            yield types.CodeLens(on.range(place), types.Command(title, COMMAND, arguments=arguments))
