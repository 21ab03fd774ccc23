# SPDX-License-Identifier: Apache-2.0
"""Regular expressions that are compiled when they are first used.

A command needs a third of the regular expressions of the modules that it imports, and to compile one takes 0.1 ms on
average, as long as to import a small module.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, AnyStr

if TYPE_CHECKING:

    def regex(text: AnyStr, flags: int = 0) -> re.Pattern[AnyStr]:
        """The regular expression `text`, with flags as for `re.compile`."""

else:

    class regex:  # noqa: N801 - used as a function
        """The attributes of the `re.Pattern`; each is looked up once, so that a call takes as long as that of a
        pattern."""

        def __init__(self, text: str | bytes, flags: int = 0) -> None:
            self._source = (text, flags)

        def __getattr__(self, name: str) -> Any:
            value = getattr(re.compile(*self._source), name)
            setattr(self, name, value)
            return value
