# SPDX-License-Identifier: Apache-2.0
"""Whether the user trusts the workspace.

A client that supports untrusted workspaces declares it: `{"trusted": false}` in its initialization options, and
`{"trusted": true}` in the notification `as2fm/didChangeTrust` once the user has granted it. Files of an untrusted
workspace are read and shown; actions that write files, or run for a long time because of these files, are rejected.
Clients that declare nothing are trusted: they do not distinguish workspaces.
"""

from __future__ import annotations

from lsprotocol.types import LSPErrorCodes
from pygls.exceptions import JsonRpcException

DID_CHANGE = "as2fm/didChangeTrust"


class NotTrustedError(JsonRpcException):
    """A request is rejected because the workspace is not trusted."""

    CODE = LSPErrorCodes.RequestFailed.value


class Trust:
    """Whether the client's user trusts the workspace.

    Attributes:
        is_granted: whether files may be written and long computations may run.
    """

    def __init__(self) -> None:
        self.is_granted = True

    def set(self, value: object) -> None:
        """Set the trust; any value other than true means that it is not granted."""
        self.is_granted = value is True

    def require(self, name: str) -> None:
        """Check that the workspace is trusted.

        Args:
            name: the name of the command or request.

        Raises:
            NotTrustedError: the workspace is not trusted.
        """
        if not self.is_granted:
            text = f"`{name}` is disabled because the workspace is not trusted; grant trust in the editor to use it"
            raise NotTrustedError(text)
