# SPDX-License-Identifier: Apache-2.0
"""The Dask cluster on which a command runs."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from as2fm_lsp.cli.model_arguments import UsageError

if TYPE_CHECKING:
    from concurrent.futures import Executor


@contextmanager
def cluster(address: str | None) -> Iterator[tuple[Executor | None, int]]:
    """The executor that runs batches of traces on a Dask cluster, and its number of workers; `None` and 0 without an
    address, for local processes."""
    if address is None:
        yield None, 0
        return
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError:
        raise UsageError("--dask needs the package distributed: pip install distributed") from None
    try:
        client = distributed.Client(address, timeout=10)
    except OSError as error:
        raise UsageError(f"there is no Dask scheduler at {address}: {error}") from None
    with client:
        yield client.get_executor(), max(1, sum(client.nthreads().values()))
