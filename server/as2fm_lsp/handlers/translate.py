# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm.translateToJani`, with the lens and the code actions that call it."""

from __future__ import annotations

import asyncio
import os
import uuid
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, TypedDict

from lsprotocol import types
from pygls.lsp.server import LanguageServer

from as2fm_lsp.convert import Converter
from as2fm_lsp.translation import OutputError, jani_path, keep_off, summary
from as2fm_lsp.write import write_file
from roaml import api
from roaml.jani.writer import write as jani_text
from roaml.project.workspace import Snapshot
from roaml.text import SourceFile

if TYPE_CHECKING:
    from as2fm_lsp.server import Server

COMMAND = "as2fm.translateToJani"
TITLE = "Translate to JANI"


class Translated(TypedDict):
    """What the command answers: the file that was written, and its size in words."""

    uri: str
    summary: str


def register(server: Server) -> None:
    session = server.session

    @server.command(COMMAND)
    async def translate(ls: LanguageServer, *arguments: object) -> Translated | None:
        """Translate a system as it stands in the editor.

        Args:
            ls: the server; pygls gives it to a function that takes any number of arguments.
            arguments: the URI of the system file, and that of the JANI file if it is not to lie beside it.

        Returns:
            null if the system cannot be translated; the user is told why.
        """
        if not 1 <= len(arguments) <= 2 or not all(isinstance(argument, str) for argument in arguments):
            _tell(server, types.MessageType.Error, f"{COMMAND} takes the URI of a system file, and that of the output.")
            return None
        path, *output = (session.convert.path(str(uri)) for uri in arguments)
        target = output[0] if output else jani_path(path)
        name = os.path.basename(path)
        async with _progress(server, f"Translating {name}"):
            try:
                system = api.loaded(session.moment().snapshot(path), path)
                keep_off(target, system)
                model = api.to_jani(system)
                write_file(target, (*jani_text(model), "\n"))
            except api.ModelError as error:
                count = len(error.result.diagnostics)
                errors = "1 error" if count == 1 else f"{count} errors"
                _tell(server, types.MessageType.Error, f"{name} has {errors} and was not translated.")
                return None
            except (api.PathError, OutputError) as error:
                _tell(server, types.MessageType.Error, str(error))
                return None
            except OSError as error:
                _tell(server, types.MessageType.Error, f"{target} cannot be written: {error.strerror or error}")
                return None
        found = summary(model)
        _tell(server, types.MessageType.Info, f"Wrote {os.path.basename(target)}: {found}.")
        return {"uri": session.convert.uri(target), "summary": found}


def lenses(snapshot: Snapshot, path: str, source: SourceFile, convert: Converter) -> Iterator[types.CodeLens]:
    """One for a system file that lies on the disk."""
    file = snapshot.analysis.system_file(path)
    if file is not None and os.path.isabs(path):
        command = types.Command(TITLE, COMMAND, arguments=[convert.uri(path)])
        yield types.CodeLens(convert.range(source, file.element.name_span), command)


def actions(snapshot: Snapshot, path: str, convert: Converter) -> Iterator[types.CodeAction]:
    """One for each system that a file belongs to; a system file belongs to itself."""
    for system in snapshot.analysis.memberships.get(path, ()):
        title = TITLE if system == path else f"Translate {os.path.basename(system)} to JANI"
        command = types.Command(title, COMMAND, arguments=[convert.uri(system)])
        yield types.CodeAction(title, kind=types.CodeActionKind.Source, command=command)


def _tell(server: Server, kind: types.MessageType, text: str) -> None:
    server.window_show_message(types.ShowMessageParams(kind, text))


@asynccontextmanager
async def _progress(server: Server, title: str) -> AsyncIterator[None]:
    """Work that the client shows as being done, if it can."""
    window = server.client_capabilities.window
    if window is None or not window.work_done_progress:
        yield
        return
    token = str(uuid.uuid4())
    await server.work_done_progress.create_async(token)
    server.work_done_progress.begin(token, types.WorkDoneProgressBegin(title))
    await asyncio.sleep(0)  # let the message out
    try:
        yield
    finally:
        server.work_done_progress.end(token, types.WorkDoneProgressEnd())
