# SPDX-License-Identifier: Apache-2.0
"""The language server: assembles its parts, and begins and ends a session.

Handlers convert the input, make one call and convert the output. Messages are handled one after the other on one event
loop, so a handler never sees a half-applied change; computations stop at their next checkpoint when their result is no
longer needed.
"""

from __future__ import annotations

import asyncio
from typing import BinaryIO

from lsprotocol import types

from as2fm_lsp import handlers, parent_process
from as2fm_lsp.client import Client
from as2fm_lsp.context import Context
from as2fm_lsp.convert import Converter
from as2fm_lsp.diagnostics import Diagnostics
from as2fm_lsp.handlers import diagnostic
from as2fm_lsp.handlers.configuration import fetch_settings
from as2fm_lsp.handlers.workspace import WATCHED, show_problems, use_folders
from as2fm_lsp.inbox import Inbox
from as2fm_lsp.progress import ProgressReporter
from as2fm_lsp.refresh import Refresh
from as2fm_lsp.requests import Requests
from as2fm_lsp.session import Session
from as2fm_lsp.sockets import Connection
from as2fm_lsp.transport import Endpoint
from as2fm_lsp.trust import Trust
from as2fm_lsp.verification.known_results import KnownResults


class Server:
    """Serves one client."""

    def __init__(self) -> None:
        self.inbox = Inbox()
        self.endpoint = Endpoint(self.inbox)
        self.requests = Requests(self.inbox, lambda: self.endpoint.request_id)
        self.session = Session(self._checkpoint)
        client, results = Client(self.endpoint), KnownResults()
        progress = ProgressReporter(client, self.inbox, self.requests)
        self.diagnostics = Diagnostics(client, self.session, self.inbox, progress)
        refresh = Refresh(client, self.session, results)
        self.diagnostics.finished = refresh.update
        self.context = Context(
            self.endpoint,
            self.session,
            client,
            self.requests,
            progress,
            self.diagnostics,
            results,
            refresh,
            Trust(),
        )
        _register(self)

    @property
    def is_shut_down(self) -> bool:
        """Whether the client has asked the server to shut down."""
        return self.endpoint.is_shut_down

    def start_io(self) -> None:
        """Serve the client that has started this process, on standard input and output."""
        self.endpoint.start_io()

    def serve_client(self, connection: Connection) -> None:
        """Serve a client that has connected to a socket."""
        self.endpoint.serve_client(connection)

    def serve(self, source: BinaryIO, target: BinaryIO) -> None:
        """Serve one client, until it requests the exit or closes the connection."""
        self.endpoint.serve(source, target)

    def _checkpoint(self) -> None:
        """Stop a computation that is not needed now.

        Raises:
            Interrupted: the result is not needed, or a message must be handled first.
        """
        if self.requests.is_handled:
            self.requests.checkpoint()
        else:
            self.diagnostics.checkpoint()


def create() -> Server:
    return Server()


def _register(server: Server) -> None:
    """Register the features, and the messages that begin and end a session."""
    context, endpoint = server.context, server.endpoint
    session, client, diagnostics = context.session, context.client, context.diagnostics

    @context.feature(types.INITIALIZE)
    def initialize(params: types.InitializeParams) -> None:
        session.convert = Converter(client.position_encoding)
        if endpoint.has_parent and params.process_id is not None:
            parent_process.watch(params.process_id, server.inbox.end)
        options = params.initialization_options if isinstance(params.initialization_options, dict) else {}
        context.trust.set(options.get("trusted", True))
        session.configure(options.get("settings") or {})
        client.use_commands(options)
        general = params.capabilities.general
        if general is not None and general.stale_request_support is not None:
            context.requests.asked_again = frozenset(general.stale_request_support.retry_on_content_modified)
        use_folders(context, [params.root_uri] if params.root_uri else [])
        text_document = params.capabilities.text_document
        asks = text_document is not None and text_document.diagnostic is not None
        diagnostics.pushes = options.get("diagnostics", "pull" if asks else "push") == "push"
        if not diagnostics.pushes:
            diagnostic.register(context)

    @context.feature(types.INITIALIZED)
    async def initialized(_: types.InitializedParams) -> None:
        if session.client_settings:  # without them, a check follows when they have arrived
            diagnostics.schedule()
        await asyncio.gather(client.watch_files(WATCHED), fetch_settings(context))
        show_problems(context)
        diagnostics.schedule()

    @context.feature(types.SHUTDOWN)
    def shutdown(_: None = None) -> None:
        endpoint.is_shut_down = True
        endpoint.cancel_requests()

    handlers.register(context)
