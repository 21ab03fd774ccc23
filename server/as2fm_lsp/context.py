# SPDX-License-Identifier: Apache-2.0
"""The context of handlers: the models, the client, and the registration."""

from __future__ import annotations

import functools
from collections.abc import Awaitable, Callable
from typing import Any, Protocol, TypeVar

from as2fm_lsp.client import Client
from as2fm_lsp.diagnostics import Diagnostics
from as2fm_lsp.progress import ProgressReporter
from as2fm_lsp.refresh import Refresh
from as2fm_lsp.requests import Requests
from as2fm_lsp.session import Session
from as2fm_lsp.trust import Trust
from as2fm_lsp.verification.known_results import KnownResults
from roaml.record import Record

Handler = TypeVar("Handler", bound=Callable[..., Any])
Command = TypeVar("Command", bound=Callable[..., Awaitable[Any]])


class Dispatcher(Protocol):
    """Calls handlers when messages arrive."""

    def on(self, method: str, handler: Callable[..., Any], options: object = None) -> None: ...

    def on_command(self, name: str, handler: Callable[..., Awaitable[Any]]) -> None: ...


class Context(Record, frozen=True):
    """One session with a client.

    Attributes:
        session: open documents, folders, settings.
        client: the client's capabilities; notifications and requests to it.
        requests: the requests of the client, and whether their answers are still needed.
        progress: shows the progress of long work in the client.
        diagnostics: computes and sends diagnostics.
        results: the known results of properties.
        refresh: asks the client to request hints and lenses again.
        trust: whether the user trusts the workspace.
    """

    dispatcher: Dispatcher
    session: Session
    client: Client
    requests: Requests
    progress: ProgressReporter
    diagnostics: Diagnostics
    results: KnownResults
    refresh: Refresh
    trust: Trust

    def feature(self, method: str, options: object = None) -> Callable[[Handler], Handler]:
        """Register the decorated function as the handler of a request or notification."""

        def register(handler: Handler) -> Handler:
            self.dispatcher.on(method, self.requests.guarded(method, handler), options)
            return handler

        return register

    def command(self, name: str, *, needs_trust: bool = True) -> Callable[[Command], Command]:
        """Register the decorated coroutine function as a command.

        Most commands write files or run for a long time, so they require a trusted workspace.
        """

        def register(handler: Command) -> Command:
            @functools.wraps(handler)
            async def run(*arguments: object) -> Any:
                if needs_trust:
                    self.trust.require(name)
                return await handler(*arguments)

            self.dispatcher.on_command(name, self.requests.guarded(name, run))
            return handler

        return register
