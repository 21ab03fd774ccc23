# SPDX-License-Identifier: Apache-2.0
"""Signature help for the function whose arguments are being typed.

Works on the characters before the caret: an incomplete expression has no useful syntax tree.
"""

from __future__ import annotations

import re

from roaml.distributions.laws import LAWS
from roaml.expr.operators import FUNCTIONS
from roaml.ide.describe import language as describe_language
from roaml.ide.syntax import expression_at, xml_file
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.regex import regex

TRIGGERS = ("(", ",")

_TOKEN = regex(r"'(?:\\.|[^'\\])*(?:'|\Z)|\"(?:\\.|[^\"\\])*(?:\"|\Z)|[()\[\]{},]", re.DOTALL)
_CALLED = regex(r"((?:\bMath\s*\.\s*)?\b\w+)\s*\Z")
_PAIRS = {")": "(", "]": "[", "}": "{"}


class SignatureHelp(Record, frozen=True):
    """The signature of a function of `Math` or of a distribution, whose call is being typed.

    Attributes:
        label: the text of the signature.
        parameters: the beginnings and ends of the parameters in `label`.
        active: the index of the parameter that is being typed; `None` if the call has more arguments than there are
            parameters.
        documentation: the description of the function, in Markdown.
    """

    label: str
    parameters: tuple[tuple[int, int], ...]
    active: int | None
    documentation: str


def signature_help(analysis: Analysis, path: str, offset: int) -> SignatureHelp | None:
    """The signature for the call at a caret; `None` outside of calls of known functions."""
    file = xml_file(analysis, path)
    if file is None:
        return None
    # A value without a closing quote does not include the blanks at its end.
    typed = len(file.document.text[:offset].rstrip())
    expression = expression_at(file, offset) or expression_at(file, typed)
    if expression is None:
        return None
    source = expression.source
    before = sum(source.offset(index) < offset for index in range(len(source.text)))
    name, commas = _innermost_call(source.text[:before])
    if name in LAWS:
        law = LAWS[name]
        label, parameters, documentation = law.signature, law.value_parameters, law.documentation
        commas, repeats = commas % len(parameters) if law.repeats else commas, False
    elif (function := FUNCTIONS.get(name.removeprefix("Math."))) is not None and name.startswith("Math."):
        label, parameters = describe_language.signature(function), function.parameters
        documentation, repeats = function.documentation, function.repeats
    else:
        return None
    at, spans = label.index("(") + 1, []
    for parameter in parameters:
        start = label.index(parameter, at)
        at = start + len(parameter)
        spans.append((start, at))
    active = commas if commas < len(spans) else len(spans) - 1 if repeats else None
    return SignatureHelp(label, tuple(spans), active, documentation)


def _innermost_call(text: str) -> tuple[str, int]:
    """The name of the function, such as `Math.abs` or `normal`, whose parentheses are open at the end of `text`, and
    the number of commas in them. The name is "" if there is no such call."""
    opened: list[tuple[str, str, int]] = []
    for token in _TOKEN.finditer(text):
        match token[0]:
            case "(" | "[" | "{" as opening:
                called = _CALLED.search(text, 0, token.start()) if opening == "(" else None
                name = "".join(called[1].split()) if called else ""
                opened.append((opening, name if name in LAWS or name.startswith("Math.") else "", 0))
            case ")" | "]" | "}" as closing:
                while opened and opened.pop()[0] != _PAIRS[closing]:
                    pass
            case "," if opened:
                bracket, name, commas = opened[-1]
                opened[-1] = (bracket, name, commas + 1)
    return next(((name, commas) for _, name, commas in reversed(opened) if name), ("", 0))
