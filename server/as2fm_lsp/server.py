# SPDX-License-Identifier: Apache-2.0
"""The language server: wiring of the protocol to `roaml`.

Handlers convert what comes in, make one call and convert what comes out. Messages are handled one after the other on
one event loop, so a handler never sees a half-applied change; what is computed gives up at its next checkpoint when
nobody waits for it any more.
"""

from __future__ import annotations

import asyncio
import functools
import json
import logging
import os
import sys
from collections.abc import Callable, Mapping
from typing import Any, BinaryIO

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInternalError, JsonRpcRequestCancelled, PyglsError
from pygls.io_ import StdoutWriter
from pygls.lsp.server import LanguageServer

from as2fm_lsp import parent
from as2fm_lsp.convert import Converter
from as2fm_lsp.diagnostics import Diagnostics
from as2fm_lsp.handlers import register
from as2fm_lsp.inbox import Inbox
from as2fm_lsp.protocol import Protocol, error_response, is_answered
from as2fm_lsp.refresh import Refresh
from as2fm_lsp.requests import Requests
from as2fm_lsp.session import Session
from as2fm_lsp.sockets import Client
from as2fm_lsp.trust import DID_CHANGE, Trust
from as2fm_lsp.verification.known_results import KnownResults
from roaml import __version__
from roaml.model.kinds import CONFIG_FILES, EXTENSIONS, PROJECT_EXTENSION

log = logging.getLogger(__name__)

SECTION = "as2fm"
"""The section of the client's settings."""


class Server(LanguageServer):
    """`session` is what the server knows, `diagnostics` what it says by itself.

    `is_shut_down` tells whether the client has asked it to shut down. `has_parent` tells whether the client has started
    this process, so that the server ends with it. `show_references` is the command of the client that shows places,
    `show_counterexample` the one that shows why a property fails, `trigger_suggest` the one that asks for completions;
    "" if it has none. `verified` is what is known of properties. `trust` says whether the user trusts the workspace.
    """

    protocol: Protocol

    def __init__(self) -> None:
        super().__init__("as2fm-lsp", __version__, protocol_cls=Protocol)
        self.is_shut_down = False
        self.has_parent = False
        self.show_references = ""
        self.show_counterexample = ""
        self.trigger_suggest = ""
        self.inbox = Inbox()
        self.requests = Requests(self.inbox, lambda: self.protocol.msg_id)
        self.trust = Trust()
        self.session = Session(self._checkpoint)
        self.diagnostics = Diagnostics(self, self.session, self.inbox)
        self.verified = KnownResults()
        self.refresh = Refresh(self)
        self.diagnostics.finished = self.refresh.look

    def use_commands(self, options: Mapping[str, Any]) -> None:
        """Take over the names of the client's commands from its `initializationOptions`."""
        self.show_references = str(options.get("showReferences") or "")
        self.show_counterexample = str(options.get("showCounterexample") or "")
        self.trigger_suggest = str(options.get("triggerSuggest") or "")

    def feature(self, feature_name: str, options: Any = None) -> Callable[[Any], Any]:
        register = super().feature(feature_name, options)
        return lambda handler: register(self.requests.guarded(feature_name, handler))

    def command(self, command_name: str, *, needs_trust: bool = True) -> Callable[[Any], Any]:
        """Most commands write files or work for long: they need a workspace that is trusted."""
        register = super().command(command_name)

        def wrapped(handler: Callable[..., Any]) -> Any:
            allowed = self.trusted_only(command_name, handler) if needs_trust else handler
            return register(self.requests.guarded(command_name, allowed))

        return wrapped

    def trusted_only(self, name: str, handler: Callable[..., Any]) -> Callable[..., Any]:
        """A handler that refuses its work in a workspace that is not trusted."""
        if asyncio.iscoroutinefunction(handler):

            @functools.wraps(handler)
            async def answer_later(*arguments: Any) -> Any:
                self.trust.require(name)
                return await handler(*arguments)

            return answer_later

        @functools.wraps(handler)
        def answer(*arguments: Any) -> Any:
            self.trust.require(name)
            return handler(*arguments)

        return answer

    def start_io(self, stdin: BinaryIO | None = None, stdout: BinaryIO | None = None) -> None:
        self.has_parent = True
        # A reader of our own: Python's is locked while a thread reads it, and the process could not end.
        source = stdin or open(sys.stdin.fileno(), "rb", closefd=False)  # noqa: SIM115 - read until the process ends
        self.serve(source, stdout or sys.stdout.buffer)

    def serve_client(self, client: Client) -> None:
        """Serve a client that has connected to a socket."""
        self.inbox.put(json.dumps(client.first).encode())
        with client.connection:
            self.serve(client.source, client.target)

    def serve(self, source: BinaryIO, target: BinaryIO) -> None:
        """Serve one client, until it tells the server to exit or has no more to say."""
        self.protocol.set_writer(StdoutWriter(target))
        try:
            asyncio.run(self._handle_messages(source))
        except BrokenPipeError:
            log.error("the connection to the client is lost")
        except (KeyboardInterrupt, SystemExit):
            pass
        finally:
            self.shutdown()  # type: ignore[no-untyped-call]

    async def _handle_messages(self, source: BinaryIO) -> None:
        asyncio.get_running_loop().set_exception_handler(_report)
        self.inbox.fill_from(source)
        async for message in self.inbox:
            try:
                self.protocol.receive(message)
            except BrokenPipeError:
                raise
            except JsonRpcException as error:
                self._refuse(message, error)
            except Exception as error:  # whatever the client sends, the session goes on
                log.exception("a message cannot be handled")
                self._refuse(message, JsonRpcInternalError(f"{type(error).__name__} in the server"))
            await asyncio.sleep(0)

    def _refuse(self, message: object, error: JsonRpcException) -> None:
        """A message that is not understood, or not now; whoever waits for an answer gets one."""
        if is_answered(message):
            self.protocol._send_data(error_response(message, error))
        else:
            log.warning("a message is ignored: %s", error)

    def _checkpoint(self) -> None:
        """
        Raises:
            Interrupted: what is computed now is not wanted, or something else is wanted first.
        """
        if self.requests.is_handled:
            self.requests.checkpoint()
        else:
            self.diagnostics.checkpoint()

    def report_server_error(self, error: Exception, source: type[PyglsError]) -> None:  # type: ignore[override]
        """A failure of ours: told in the log, without a pop-up for each keystroke. A refusal is none."""
        if not isinstance(error, JsonRpcException) or isinstance(error, JsonRpcInternalError):
            known = error.data if isinstance(error, JsonRpcException) and isinstance(error.data, dict) else {}
            log.error("%s\n%s", source.__name__, "".join(known.get("traceback", ())), exc_info=error)

    def ask_to_pull(self) -> None:
        """Diagnostics have changed that the client fetches by itself."""
        workspace = self.client_capabilities.workspace
        if workspace is not None and workspace.diagnostics and workspace.diagnostics.refresh_support:
            self.workspace_diagnostic_refresh(None)

    def tell_problems(self) -> None:
        """What is wrong with the configuration and was not told yet."""
        for problem in dict.fromkeys(self.session.problems):
            self.window_show_message(types.ShowMessageParams(types.MessageType.Warning, problem))
        self.session.problems.clear()


def _report(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """What went wrong where nobody waits; that somebody does not wait any more is nothing wrong."""
    if not isinstance(context.get("exception"), JsonRpcRequestCancelled):
        loop.default_exception_handler(context)


def create() -> Server:
    server = Server()
    _documents(server)
    _workspace(server)
    _trust(server)
    register(server)
    return server


# ------------------------------------------------------------------- documents


def _documents(server: Server) -> None:
    session, diagnostics = server.session, server.diagnostics

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def did_open(params: types.DidOpenTextDocumentParams) -> None:
        document = params.text_document
        path = session.convert.path(document.uri)
        session.open(path, document.text, document.version)
        server.tell_problems()
        diagnostics.schedule(path)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def did_change(params: types.DidChangeTextDocumentParams) -> None:
        path = session.convert.path(params.text_document.uri)
        session.change(path, params.content_changes, params.text_document.version)
        diagnostics.schedule(path)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def did_save(params: types.DidSaveTextDocumentParams) -> None:
        path = session.convert.path(params.text_document.uri)
        session.look_again()
        if os.path.basename(path) in CONFIG_FILES:
            session.configure()
            server.tell_problems()
        diagnostics.schedule(path)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def did_close(params: types.DidCloseTextDocumentParams) -> None:
        path = session.convert.path(params.text_document.uri)
        session.close(path)
        diagnostics.schedule(path)


# ------------------------------------------------------------------- workspace


def _workspace(server: Server) -> None:
    session, diagnostics = server.session, server.diagnostics

    @server.feature(types.INITIALIZE)
    def initialize(params: types.InitializeParams) -> None:
        session.convert = Converter(types.PositionEncodingKind(server.workspace.position_encoding))
        if server.has_parent and params.process_id is not None:
            parent.watch(params.process_id, server.inbox.end)
        options = params.initialization_options if isinstance(params.initialization_options, dict) else {}
        server.trust.set(options.get("trusted", True))
        session.configure(options.get("settings") or {})
        server.use_commands(options)
        general = params.capabilities.general
        if general is not None and general.stale_request_support is not None:
            server.requests.asked_again = frozenset(general.stale_request_support.retry_on_content_modified)
        session.set_folders(session.convert.path(folder.uri) for folder in server.workspace.folders.values())
        if not server.workspace.folders and params.root_uri:
            session.set_folders([session.convert.path(params.root_uri)])
        text_document = params.capabilities.text_document
        asks = text_document is not None and text_document.diagnostic is not None
        diagnostics.pushes = options.get("diagnostics", "pull" if asks else "push") == "push"
        if not diagnostics.pushes:
            _pull(server)

    @server.feature(types.INITIALIZED)
    async def initialized(_: types.InitializedParams) -> None:
        if session.client_settings:  # while the client, busy with its own start, is asked for what may be the same
            diagnostics.schedule()
        await asyncio.gather(_watch(server), _fetch_settings(server))
        server.tell_problems()
        diagnostics.schedule()

    @server.feature(types.SHUTDOWN)
    def shutdown(_: None = None) -> None:
        server.is_shut_down = True
        # pygls does the same, but stumbles over a command that runs: cancelling it takes it out of what is iterated.
        for id_, future in tuple(server.protocol._request_futures.items()):
            if id_ != server.protocol.msg_id and not future.done():
                future.cancel()

    @server.feature(types.WORKSPACE_DID_CHANGE_CONFIGURATION)
    async def did_change_configuration(params: types.DidChangeConfigurationParams) -> None:
        if not await _fetch_settings(server):
            settings = params.settings if isinstance(params.settings, dict) else {}
            session.configure(settings.get(SECTION, settings) or {})
        server.tell_problems()
        diagnostics.schedule()

    @server.feature(types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS)
    def did_change_folders(_: types.DidChangeWorkspaceFoldersParams) -> None:
        session.set_folders(session.convert.path(folder.uri) for folder in server.workspace.folders.values())
        server.tell_problems()
        diagnostics.schedule()

    @server.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def did_change_watched_files(params: types.DidChangeWatchedFilesParams) -> None:
        paths = [session.convert.path(change.uri) for change in params.changes]
        session.look_again()
        if any(os.path.basename(path) in CONFIG_FILES for path in paths):
            session.configure()
            server.tell_problems()
        if any(change.type is not types.FileChangeType.Changed for change in params.changes):
            session.refresh()
        diagnostics.schedule()


def _trust(server: Server) -> None:
    @server.feature(DID_CHANGE)
    def did_change_trust(params: Any) -> None:
        server.trust.set(getattr(params, "trusted", None))


def _pull(server: Server) -> None:
    """Let the client ask for diagnostics."""
    session, diagnostics = server.session, server.diagnostics
    options = types.DiagnosticOptions(inter_file_dependencies=True, workspace_diagnostics=True, identifier=SECTION)

    @server.feature(types.TEXT_DOCUMENT_DIAGNOSTIC, options)
    def document_diagnostic(params: types.DocumentDiagnosticParams) -> types.DocumentDiagnosticReport:
        path = session.convert.path(params.text_document.uri)
        return diagnostics.document_report(path, params.previous_result_id)

    @server.feature(types.WORKSPACE_DIAGNOSTIC)
    async def workspace_diagnostic(params: types.WorkspaceDiagnosticParams) -> types.WorkspaceDiagnosticReport:
        return await diagnostics.workspace_report(params.previous_result_ids)


async def _fetch_settings(server: Server) -> bool:
    """Ask the client for its settings; whether it can be asked."""
    workspace = server.client_capabilities.workspace
    if workspace is None or not workspace.configuration:
        return False
    item = types.ConfigurationItem(section=SECTION)
    try:
        answer: Any = await server.workspace_configuration_async(types.ConfigurationParams([item]))
    except Exception as error:  # a client that cannot answer is as good as one without settings
        log.warning("the client's settings cannot be read: %s", error)
        return False
    settings = answer[0] if answer and isinstance(answer[0], dict) else {}
    if settings != server.session.client_settings:  # what is known was found out with the settings
        server.session.configure(settings)
    return True


async def _watch(server: Server) -> None:
    """Be told of changes on the disk, if the client can do so."""
    workspace = server.client_capabilities.workspace
    watched = workspace.did_change_watched_files if workspace else None
    if watched is None or not watched.dynamic_registration:
        return
    extensions = (*EXTENSIONS, PROJECT_EXTENSION)
    patterns = [*(f"**/*{extension}" for extension in extensions), *(f"**/{name}" for name in CONFIG_FILES)]
    options = types.DidChangeWatchedFilesRegistrationOptions([types.FileSystemWatcher(p) for p in patterns])
    registration = types.Registration("as2fm-files", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
    try:
        await server.client_register_capability_async(types.RegistrationParams([registration]))
    except Exception as error:  # without it, files are looked at again with each change of a document
        log.warning("files cannot be watched: %s", error)
