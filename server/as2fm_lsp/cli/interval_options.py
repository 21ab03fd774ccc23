# SPDX-License-Identifier: Apache-2.0
"""Parameters that `verify` only knows to be in intervals: `--set p=[0.85,0.95]` (docs/spec/parameters.md#intervals)."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from as2fm_lsp.cli.mock_options import declarations_in
from as2fm_lsp.cli.model_arguments import UsageError
from as2fm_lsp.cli.parameters import with_parameter_files
from as2fm_lsp.cli.tree_semantics import semantics_of
from as2fm_lsp.cli.verify_arguments import asks_for_traces
from roaml import api
from roaml.model.parameters import Overrides
from roaml.project.settings import Settings

if TYPE_CHECKING:
    from roaml.verification.target import VerificationTarget


def has_intervals(options: argparse.Namespace) -> bool:
    """Whether the value of a parameter or constant is an interval."""
    texts = (*(value for _, value in options.set), *(text.partition("=")[2] for text in options.constant))
    return any(text.lstrip().startswith("[") for text in texts)


def target_over_intervals(options: argparse.Namespace, settings: Settings) -> VerificationTarget:
    """The model that the arguments name, over the intervals. All its states are to be explored.

    Raises:
        UsageError: the intervals do not fit the model or the other options.
        api.PathError, api.ConstantError, api.ModelError, api.JaniError: as `api.target`.
    """
    if not declarations_in(options).is_empty:
        raise UsageError("intervals cannot be combined with mocks; write the mocks as plugins (`as2fm-lsp init`)")
    if options.scheduler is not None or (asks_for_traces(options) and not options.exhaustive):
        raise UsageError(
            "bounds over intervals are computed from all states; leave out the options for random traces and schedulers"
        )
    pairs = (*options.set, *((name.strip(), value) for name, _, value in (t.partition("=") for t in options.constant)))
    settings = with_parameter_files(settings, options.params_file)
    overrides = Overrides(options.max_time, None, options.reaction_time, semantics=semantics_of(options))
    try:
        return api.over_intervals(options.main, dict(pairs), options.ros_path, settings, overrides)
    except api.IntervalError as error:
        raise UsageError(str(error)) from None
