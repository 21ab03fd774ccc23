# SPDX-License-Identifier: Apache-2.0
"""The client: its capabilities, and the notifications and requests to it."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from typing import Any

from lsprotocol import types

from as2fm_lsp.transport import Endpoint

log = logging.getLogger(__name__)

SECTION = "as2fm"
"""The name of the section of the client's settings that the server reads."""


class Client:
    """The client.

    Args:
        endpoint: the connection.

    Attributes:
        show_references: the command of the client that shows places; "" if it has none.
        show_counterexample: the command that explains why a property fails.
        show_witness: the command that explains why a property holds.
        debug_counterexample: the command that debugs a trace in which a property fails.
        debug_model: the command that debugs a system or a tree.
        edit_mocks: the command that shows the mocks of a tree to edit them.
        set_expectation: the command that asks for the expected value of a property.
        experiment: the command that asks for the values of parameters and runs an experiment.
        trigger_suggest: the command that requests completions.
    """

    def __init__(self, endpoint: Endpoint) -> None:
        self.show_references = ""
        self.show_counterexample = ""
        self.show_witness = ""
        self.debug_counterexample = ""
        self.debug_model = ""
        self.edit_mocks = ""
        self.set_expectation = ""
        self.experiment = ""
        self.trigger_suggest = ""
        self._endpoint = endpoint

    def use_commands(self, options: Mapping[str, Any]) -> None:
        """Read the names of the client's commands from its `initializationOptions`."""
        self.show_references = str(options.get("showReferences") or "")
        self.show_counterexample = str(options.get("showCounterexample") or "")
        self.show_witness = str(options.get("showWitness") or "")
        self.set_expectation = str(options.get("setExpectation") or "")
        self.debug_counterexample = str(options.get("debugCounterexample") or "")
        self.debug_model = str(options.get("debugModel") or "")
        self.edit_mocks = str(options.get("editMocks") or "")
        self.experiment = str(options.get("experiment") or "")
        self.trigger_suggest = str(options.get("triggerSuggest") or "")

    # ------------------------------------------------------------------ facts

    @property
    def capabilities(self) -> types.ClientCapabilities:
        return self._endpoint.client_capabilities

    @property
    def position_encoding(self) -> types.PositionEncodingKind:
        """The negotiated encoding of positions."""
        return types.PositionEncodingKind(self._endpoint.workspace.position_encoding)

    @property
    def folders(self) -> tuple[str, ...]:
        """The URIs of the open folders."""
        return tuple(folder.uri for folder in self._endpoint.workspace.folders.values())

    # ---------------------------------------------------------- notifications

    def show_message(self, kind: types.MessageType, text: str) -> None:
        self._endpoint.window_show_message(types.ShowMessageParams(kind, text))

    def publish_diagnostics(self, uri: str, diagnostics: list[types.Diagnostic], version: int | None) -> None:
        self._endpoint.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, diagnostics, version))

    def send_partial_result(self, token: int | str, value: dict[str, Any]) -> None:
        """Send a part of an answer before the answer, with the token that the client has given for it."""
        self._endpoint.progress(types.ProgressParams(token, value))

    # --------------------------------------------------------------- requests

    async def show_document(self, place: types.Location) -> None:
        """Show a place, if the client can."""
        window = self.capabilities.window
        if window is not None and window.show_document is not None and window.show_document.support:
            params = types.ShowDocumentParams(place.uri, take_focus=True, selection=place.range)
            await self._endpoint.window_show_document_async(params)

    def refresh_diagnostics(self) -> None:
        """Ask the client to request diagnostics again, if it requests them itself."""
        workspace = self.capabilities.workspace
        if workspace is not None and workspace.diagnostics and workspace.diagnostics.refresh_support:
            self._endpoint.workspace_diagnostic_refresh(None)

    def refresh_inlay_hints(self) -> None:
        self._endpoint.workspace_inlay_hint_refresh(None)

    def refresh_code_lenses(self) -> None:
        self._endpoint.workspace_code_lens_refresh(None)

    async def settings(self) -> dict[str, Any] | None:
        """The client's settings; `None` if the client does not support the request, or cannot answer it."""
        workspace = self.capabilities.workspace
        if workspace is None or not workspace.configuration:
            return None
        item = types.ConfigurationItem(section=SECTION)
        try:
            answer: Any = await self._endpoint.workspace_configuration_async(types.ConfigurationParams([item]))
        except Exception as error:  # a client that cannot answer is treated like one without settings
            log.warning("the client's settings cannot be read: %s", error)
            return None
        return answer[0] if answer and isinstance(answer[0], dict) else {}

    async def watch_files(self, patterns: Iterable[str]) -> None:
        """Subscribe to changes on the disk, if the client supports it."""
        workspace = self.capabilities.workspace
        watched = workspace.did_change_watched_files if workspace else None
        if watched is None or not watched.dynamic_registration:
            return
        watchers = [types.FileSystemWatcher(pattern) for pattern in patterns]
        options = types.DidChangeWatchedFilesRegistrationOptions(watchers)
        registration = types.Registration("as2fm-files", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
        try:
            await self._endpoint.client_register_capability_async(types.RegistrationParams([registration]))
        except Exception as error:  # then every change of a document makes the session read the files again
            log.warning("files cannot be watched: %s", error)

    # --------------------------------------------------------------- progress

    async def create_progress(self, token: str) -> None:
        """Register a progress token with the client.

        Raises:
            Exception: the client does not support it.
        """
        await self._endpoint.work_done_progress.create_async(token)

    def begin_progress(self, token: str, begin: types.WorkDoneProgressBegin) -> None:
        self._endpoint.work_done_progress.begin(token, begin)

    def report_progress(self, token: str, report: types.WorkDoneProgressReport) -> None:
        self._endpoint.work_done_progress.report(token, report)

    def end_progress(self, token: str) -> None:
        self._endpoint.work_done_progress.end(token, types.WorkDoneProgressEnd())
        self._endpoint.work_done_progress.tokens.pop(token, None)
