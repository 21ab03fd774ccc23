# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-member`, which unknown_member.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import UnknownMember
from roaml.expr.types import Array, Struct, StructKind, unwrap
from roaml.expr.zero import zero_text
from roaml.model.initial import ExtraMember, MissingMembers
from roaml.model.value_types import TypedValue
from roaml.regex import regex
from roaml.rules.rule import MachineContext, Rule, close_names, listing, replacements
from roaml.rules.support.fields import is_ros
from roaml.suggest import alternatives
from roaml.text import Span, TextEdit

QUOTE = regex(r"['\"]|&(?:quot|apos|#[xX]?[0-9a-fA-F]+);")


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            match problem:
                case UnknownMember():
                    finding = _unknown(problem)
                    if finding is not None:
                        yield finding
                case ExtraMember(twice=True):
                    yield RULE.at(problem.span, f"the member `{problem.name}` is given twice; remove one of them")
                case ExtraMember():
                    close = close_names(problem.name, [name for name, _ in problem.struct.members])
                    hint = alternatives(close, [name for name, _ in problem.struct.members], "member")
                    message = f"`{problem.struct}` has no member `{problem.name}`{hint}"
                    inside = _without_quotes(problem.span, context.source.text)
                    yield RULE.at(problem.span, message, *replacements(inside, close))
                case MissingMembers():
                    names = _really_missing(problem, value)
                    if names:
                        message = f"the value has no {listing(names)}, which `{problem.struct}` requires"
                        yield RULE.at(problem.span, message, *_add(context, problem, names))


def _add(context: MachineContext, problem: MissingMembers, names: list[str]) -> Iterator[Fix]:
    """A fix that adds the missing members with the zero values of their types."""
    text = context.source.text[slice(*problem.span)]
    values = [zero_text(type_) for name in names if (type_ := problem.struct.member(name)) is not None]
    if text[-1:] != "}" or len(values) < len(names):
        return
    inside = text[1:-1].rstrip()
    at = problem.span.start + 1 + len(inside)
    new = ", ".join(f"'{name}': {value}" for name, value in zip(names, values, strict=True))
    if '"' in text:
        new = new.replace("'", '"')
    comma = ", " if inside.strip() and not inside.endswith(",") else ""
    members = "member" if len(names) == 1 else "members"
    yield Fix(f"Add the missing {members}", (TextEdit(Span(at, at), comma + new),))


def _really_missing(problem: MissingMembers, value: TypedValue) -> list[str]:
    """The missing members, without those that are only misspelled."""
    extra = [
        other.name
        for other in value.problems
        if isinstance(other, ExtraMember) and other.struct == problem.struct and problem.span.contains(other.span.start)
    ]
    misspelled = {close for name in extra for close in close_names(name, problem.names, 1)}
    return [name for name in problem.names if name not in misspelled]


def _without_quotes(span: Span, text: str) -> Span:
    """The span of a member's name, without the quotes around it."""
    quote = QUOTE.match(text, span.start, span.end)
    width = quote.end() - span.start if quote else 0
    return Span(span.start + width, span.end - width)


def _unknown(problem: UnknownMember) -> Finding | None:
    inner, _ = unwrap(problem.owner)
    if not isinstance(inner, Struct):
        phrase = "an array" if isinstance(problem.owner, Array) else f"of type `{problem.owner}`"
        only = "; its only member is `.length`" if isinstance(problem.owner, Array) else ""
        return RULE.at(problem.span, f"this is {phrase} and has no member `{problem.name}`{only}")
    if is_ros(inner) or inner.kind is StructKind.EVENT:
        return None  # unknown-field and unknown-event-parameter report these with more detail
    close = close_names(problem.name, [name for name, _ in inner.members])
    owner = f"`{inner}`" if inner.name else f"the {inner.what}"
    hint = alternatives(close, [name for name, _ in inner.members], "member")
    message = f"{owner} has no member `{problem.name}`{hint}"
    return RULE.at(problem.span, message, *replacements(problem.span, close))


RULE = Rule("unknown-member", Severity.ERROR, "A struct does not have a member that is used.", machine=check)
