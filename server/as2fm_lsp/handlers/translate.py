# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm.translateToJani`, with the lens and the code actions that call it."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from itertools import chain
from typing import TypedDict

from lsprotocol import types

from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.context import Context
from as2fm_lsp.convert import Converter
from as2fm_lsp.handlers.first_error import counted, show
from as2fm_lsp.outputs import check_can_write
from as2fm_lsp.progress import Progress
from as2fm_lsp.translation import jani_path, summary, without_bounded
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.ide.system_names import system_names
from roaml.interruption import Interrupted
from roaml.jani.model import Model
from roaml.jani.writer import write as jani_text
from roaml.project.paths import is_on_disk
from roaml.project.workspace import Snapshot
from roaml.text import SourceFile

COMMAND = "as2fm.translateToJani"
TITLE = "Translate to JANI"


class Translated(TypedDict):
    """The result of the command: the file that was written, and its size as a phrase."""

    uri: str
    summary: str


def register(context: Context) -> None:
    session = context.session

    @context.command(COMMAND)
    async def translate(*arguments: object) -> Translated | None:
        """Translate a system as it is in the editor.

        Args:
            arguments: the URI of the system file, and that of the JANI file unless it is beside the system file.

        Returns:
            null if the system cannot be translated; a message states the reason.
        """
        if not 1 <= len(arguments) <= 2 or not all(isinstance(argument, str) for argument in arguments):
            text = f"{COMMAND} needs the URI of a system file, and optionally that of the output."
            context.client.show_message(types.MessageType.Error, text)
            return None
        path, *output = (session.convert.path(str(uri)) for uri in arguments)
        target = output[0] if output else jani_path(path)
        name = os.path.basename(path)
        async with context.progress.show(f"Translating {name}", cancellable=True) as shown:
            try:
                with context.requests.cancelled_by(shown.token):
                    model, left_out = await _write(context, shown, path, target)
            except Interrupted:
                if shown.is_cancelled:
                    return None
                raise
            except api.ModelError as error:
                errors = counted(error.result.diagnostics)
                context.client.show_message(types.MessageType.Error, f"{name} has {errors} and was not translated.")
                await show(context, error.result.snapshot, error.result.diagnostics)
                return None
            except api.PathError as error:
                context.client.show_message(types.MessageType.Error, str(error))
                return None
            except OSError as error:
                context.client.show_message(
                    types.MessageType.Error, f"{target} cannot be written: {error.strerror or error}"
                )
                return None
        for warning in left_out:
            context.client.show_message(types.MessageType.Warning, f"{warning.message} [{warning.code}]")
        size = summary(model)
        context.client.show_message(types.MessageType.Info, f"Wrote {os.path.basename(target)}: {size}.")
        return {"uri": session.convert.uri(target), "summary": size}


def lenses(snapshot: Snapshot, path: str, source: SourceFile, convert: Converter) -> Iterator[types.CodeLens]:
    """The lens of a system file that translates it, if the file is on the disk."""
    file = snapshot.analysis.system_file(path)
    if file is not None and is_on_disk(path):
        command = types.Command(TITLE, COMMAND, arguments=[convert.uri(path)])
        yield types.CodeLens(convert.range(source, file.element.name_span), command)


async def _write(context: Context, shown: Progress, path: str, target: str) -> tuple[Model, tuple[Diagnostic, ...]]:
    """Write the translation of a system, in its current state, to a file. Other messages are handled between the steps.

    Returns:
        The model, and a warning for each reason why a property is not part of it.

    Raises:
        Interrupted: the client has cancelled the translation. The file is unchanged.
    """
    snapshot = context.session.moment().snapshot(path)
    await shown.step("checking")
    system = api.loaded(snapshot, path)
    check_can_write(target, system.files, translates=True)
    await shown.step("translating")
    model, left_out = without_bounded(api.to_jani(system))
    await shown.step("writing")
    write_file(target, _while_needed(context, chain(jani_text(model), "\n")))
    return model, left_out


def _while_needed(context: Context, pieces: Iterable[str]) -> Iterator[str]:
    for piece in pieces:
        context.requests.checkpoint()
        yield piece


def actions(snapshot: Snapshot, path: str, convert: Converter) -> Iterator[types.CodeAction]:
    """A code action for each system that a file belongs to; a system file belongs to the system that it describes."""
    for system, name in system_names(snapshot.analysis.memberships.get(path, ())).items():
        title = TITLE if system == path else f"Translate {name} to JANI"
        command = types.Command(title, COMMAND, arguments=[convert.uri(system)])
        yield types.CodeAction(title, kind=types.CodeActionKind.Source, command=command)
