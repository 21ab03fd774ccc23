# SPDX-License-Identifier: Apache-2.0
"""Whole numbers and sizes on the command line."""

from __future__ import annotations

import argparse
import re


def _whole(text: str) -> int:
    try:
        return int(text) if len(text) < 30 else -1
    except ValueError:
        return -1


def positive(text: str) -> int:
    """A whole number from 1 to 2^62 - 1.

    Raises:
        argparse.ArgumentTypeError: the text is not a number in this range.
    """
    value = _whole(text)
    if not 1 <= value < 1 << 62:
        raise argparse.ArgumentTypeError("expected a whole number of at least 1")
    return value


def natural(text: str) -> int:
    """A whole number from 0 to 2^63 - 1.

    Raises:
        argparse.ArgumentTypeError: the text is not a number in this range.
    """
    value = _whole(text)
    if not 0 <= value < 1 << 63:
        raise argparse.ArgumentTypeError("expected a whole number from 0 to 2^63 - 1")
    return value


def size(text: str) -> int:
    """A number of bytes from a text such as `4G`, `500M` or `100000`; the units are powers of 1024.

    Raises:
        argparse.ArgumentTypeError: the text is not a size, or the size is 0.
    """
    match = re.fullmatch(r"(\d{1,15})([KMGT]?)(i?B)?", text, re.IGNORECASE)
    if match is None or int(match[1]) == 0:
        raise argparse.ArgumentTypeError("expected a size such as 4G or 500M")
    return int(match[1]) << (10 * " KMGT".index(match[2].upper() or " "))
