# SPDX-License-Identifier: Apache-2.0
"""Whether the user trusts the workspace.

A client that knows workspaces which are not trusted says so: `{"trusted": false}` in its initialization options, and
`{"trusted": true}` in the notification `as2fm/didChangeTrust` once the user has granted it. Files of such a workspace
are read and shown; what writes files, or works for long because these files say so, is refused. Clients that say
nothing are trusted: they know of no other workspaces.
"""

from __future__ import annotations

from lsprotocol.types import LSPErrorCodes
from pygls.exceptions import JsonRpcException

DID_CHANGE = "as2fm/didChangeTrust"


class NotTrustedError(JsonRpcException):
    """What was asked for is refused."""

    CODE = LSPErrorCodes.RequestFailed.value


class Trust:
    """Attributes:
    is_granted: whether files may be written, and time be spent.
    """

    def __init__(self) -> None:
        self.is_granted = True

    def set(self, value: object) -> None:
        """What the client says; anything but true means that it is not granted."""
        self.is_granted = value is True

    def require(self, name: str) -> None:
        """
        Args:
            name: of the command or request.

        Raises:
            NotTrustedError: the workspace is not trusted.
        """
        if not self.is_granted:
            text = f"`{name}` is off because the workspace is not trusted; grant trust in the editor to use it"
            raise NotTrustedError(text)
