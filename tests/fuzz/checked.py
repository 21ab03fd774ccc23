# SPDX-License-Identifier: Apache-2.0
"""The invariants of a complete check of some files with any content, and of fixes and translations that follow it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from random import Random

from fuzz.limits import restart
from fuzz.strategy import Failure
from fuzz.translation import problems
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.model.size import Limits
from roaml.project.settings import Settings
from roaml.text import Span, apply_edits

LIMITS = Limits(cells=50_000, parts=50_000)
"""A fraction of the real limits. Input just below them takes about as long as a case may take."""


def problems_of_check(
    main: str,
    texts: Mapping[str, str],
    ros_paths: Sequence[str] = (),
    random: Random | None = None,
    settings: Settings | None = None,
) -> Iterator[Failure]:
    """Checks files, translates the systems among them that have no errors, and reads the translations.

    Args:
        main: the file or folder that is checked.
        texts: path -> text that replaces the text on the disk.
        random: if given, sometimes one fix is applied and the check repeated.
        settings: default: the usual ones, with `LIMITS`.
    """
    result = api.check([main], ros_paths, settings or Settings(limits=LIMITS), texts)
    for diagnostic in result.diagnostics:
        yield from _diagnostic(result, diagnostic)
    for system in result.snapshot.analysis.system_paths:
        restart()
        yield from (Failure(kind, f"{system}: {kind}") for kind in problems(result.snapshot, system))
    fixes = [(d.path, fix) for d in result.diagnostics for fix in d.fixes if d.path in texts]
    if random is not None and fixes and random.random() < 0.1:
        restart()
        path, fix = random.choice(fixes)
        fixed = {**texts, path: apply_edits(texts[path], fix.edits)}
        for failure in problems_of_check(main, fixed, ros_paths, settings=settings):
            yield Failure(failure.kind, f"after the fix `{fix.title}`: {failure.details}")


def _diagnostic(result: api.CheckResult, diagnostic: Diagnostic) -> Iterator[Failure]:
    where = f"{diagnostic.code} in {diagnostic.path}: {diagnostic.message[:300]}"
    if diagnostic.code == "internal-error":
        yield Failure("internal-error", where)
    if not diagnostic.message.strip():
        yield Failure(f"no message: {diagnostic.code}", where)
    length = len(result.source(diagnostic.path).text)
    if not _inside(diagnostic.span, length):
        yield Failure(f"range outside: {diagnostic.code}", f"{diagnostic.span} of {length}: {where}")
    for fix in diagnostic.fixes:
        if not all(_inside(edit.span, length) for edit in fix.edits):
            yield Failure(f"fix outside: {diagnostic.code}", f"{fix} of {length}: {where}")
    for related in diagnostic.related:
        source = result.snapshot.analysis.source(related.location.path)
        if source is None or not _inside(related.location.span, len(source.text)):
            yield Failure(f"related place outside: {diagnostic.code}", f"{related}: {where}")


def _inside(span: Span, length: int) -> bool:
    return 0 <= span.start <= span.end <= length
