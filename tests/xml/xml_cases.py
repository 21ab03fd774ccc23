# SPDX-License-Identifier: Apache-2.0
"""The shape of a tree in one line.

    <a b="c"><d/>text</a>
    a[b=c](d/ 'text')

Names, attributes in brackets, children in parentheses; `/` follows a self-closing element, `~` one that is not
complete; `'text'`, `!comment`, `?instruction`, `{CDATA}`.
"""

from __future__ import annotations

from roaml.xml_syntax import CData, Comment, Document, Element, Instruction, Node


def shape(document: Document) -> str:
    return " ".join(filter(None, map(_shape, document.nodes)))


def _shape(node: Node) -> str:
    match node:
        case Element():
            return _element(node)
        case Comment():
            return f"!{node.value.strip()}"
        case Instruction():
            return f"?{node.value.split()[0]}" if node.value.split() else "?"
        case CData():
            return f"{{{node.value}}}"
    return f"'{node.value.strip()}'" if node.value.strip() else ""


def _element(element: Element) -> str:
    attributes = " ".join(f"{a.name}={a.value}" if a.has_value else a.name for a in element.attributes)
    children = " ".join(filter(None, map(_shape, element.nodes)))
    return "".join(
        (
            f"{element.prefix}:" if element.prefix else "",
            element.name,
            f"[{attributes}]" if attributes else "",
            f"({children})" if children else "",
            "/" if element.self_closing else "",
            "" if element.complete else "~",
        )
    )
