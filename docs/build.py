# SPDX-License-Identifier: Apache-2.0
"""Writes what follows from other files: the reference manual, from the schemas and the rule documents; the nodes of
the schema of trees; and the tables that the program reads (`docs/tables.py`): `python docs/build.py`.

The writer is also the test that all of these are current: `python docs/build.py --check` writes nothing and exits with
1 if a file differs from what would be written.
"""

from __future__ import annotations

import argparse
import importlib
import json
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import node_schema
from tables import grammars, libraries, update

from as2fm_lsp.cli import compare, debug, draw, experiment, explain, init, migrate, simulate, translate, verify
from as2fm_lsp.cli import format as layout
from as2fm_lsp.cli.main import COMMANDS, EXAMPLES, parser
from roaml.expr.operators import FUNCTIONS, Operator, UnaryOperator
from roaml.language import BEHAVIOR_TREE, HL_SCXML, STRUCTS, SYSTEM, XML_PROPERTIES
from roaml.language.grammar import AttributeType, ElementType, Grammar
from roaml.language.resources import schema_path
from roaml.roles import UNBOUNDED
from roaml.rules import GROUPS, RULES, document, document_file, in_reference

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
REFERENCE = HERE / "reference"
NOTICE = "<!-- Written by docs/build.py. Change the schemas or rule documents instead. -->\n"

LANGUAGES = {
    "machines": (HL_SCXML, "State machines: HL-SCXML"),
    "systems": (SYSTEM, "The system file"),
    "trees": (BEHAVIOR_TREE, "Behavior trees"),
    "structs": (STRUCTS, "Struct declarations"),
    "xml-properties": (XML_PROPERTIES, "Properties in XML"),
}


def pages() -> dict[str, str]:
    """File name -> text of each page of the reference."""
    texts = {f"{name}.md": language(grammar, title) for name, (grammar, title) in LANGUAGES.items()}
    texts["expressions.md"] = expressions()
    texts["properties.md"] = properties()
    texts["rules.md"] = rules()
    texts["command-line.md"] = command_line()
    texts["README.md"] = contents()
    return {name: text if name == "README.md" else f"{NOTICE}\n{text}" for name, text in texts.items()}


def contents() -> str:
    rows = [f"- [{title}]({name}.md)" for name, (_, title) in LANGUAGES.items()]
    rows += [
        "- [Expressions](expressions.md)",
        "- [Properties in JANI](properties.md)",
        "- [Rules](rules.md)",
        "- [Command line](command-line.md)",
    ]
    return f"{NOTICE}\n# Reference\n\n" + "\n".join(rows) + "\n"


# ------------------------------------------------------------------- languages


def language(grammar: Grammar, title: str) -> str:
    roots = " or ".join(f"`<{root}>`" for root in grammar.roots)
    parts = [f"# {title}\n\nThe root is {roots}. The grammar is defined in `schemas/{grammar.schema}`.\n"]
    parts += [element(declared, grammar) for declared in grammar.elements.values()]
    return "\n".join(parts)


def element(type_: ElementType, grammar: Grammar, inside: str = "") -> str:
    where = f" in `<{inside}>`" if inside else ""
    lines = [f"## `<{type_.name}>`{where}\n", type_.documentation + "\n"]
    if type_.use:
        lines.append(f"*Older spelling; write `{type_.use}`.*\n")
    global_ = grammar.elements
    parents = [p for p in grammar.parents(type_.name) if p not in global_ or type_.name not in global_[p].local]
    if parents and not inside:
        lines.append(f"Parents: {', '.join(f'`<{p}>`' for p in parents)}.\n")
    if type_.binds:
        lines.append(f"Event variables: {', '.join(f'`{b.name}`' for b in type_.binds)}.\n")
    if type_.attributes:
        lines += ["| attribute | required | meaning |", "| --- | --- | --- |"]
        lines += [attribute(declared) for declared in type_.attributes.values()]
        lines.append("")
    if type_.children:
        lines += ["| child | how often |", "| --- | --- |"]
        lines += [f"| `<{name}>` | {often(o.least, o.most)} |" for name, o in type_.children.items()]
        lines.append("")
    if type_.any_child:
        lines.append(f"Children: {often(type_.any_child.least, type_.any_child.most)}, of any kind.\n")
    lines += [element(local, grammar, type_.name) for local in type_.local.values()]
    return "\n".join(lines)


def attribute(type_: AttributeType) -> str:
    text = type_.documentation
    if type_.port:
        text += f" An {type_.port.direction}put port of type `{type_.port.type}`"
        text += ", which must hold a constant." if type_.port.constant else "."
    for choice in type_.simple.choices:
        text += f" `{choice.value}`: {choice.documentation}"
    cell = re.sub(r"\s+", " ", text).replace("|", "\\|")
    required = type_.required or (type_.port is not None and type_.port.required)
    return f"| `{type_.name}` | {'yes' if required else ''} | {cell} |"


def often(least: int, most: int) -> str:
    if most >= UNBOUNDED:
        return "any number" if least == 0 else f"at least {least}"
    return str(least) if least == most else f"{least} to {most}"


# ------------------------------------------------------------ everything else


def expressions() -> str:
    binary = "\n".join(f"| `{cell(o.symbol)}` | {o.kind} | {o.precedence} |" for o in Operator)
    unary = ", ".join(f"`{o.symbol}`" for o in UnaryOperator)
    functions = "\n".join(f"| `{f.signature}` | {f.documentation} |" for f in FUNCTIONS.values())
    return f"""# Expressions

Expressions are a part of ECMAScript 5. They are written in `cond`, `expr`, `location` and some other attributes, where
`<` is written `&lt;` and `&&` is written `&amp;&amp;`.

## Values

Numbers (`3`, `2.5`, `1e-3`, `0x10`), `true` and `false`, strings in single or double quotes, arrays (`[1, 2]`) and, as
initial values, structs (`{{'x': 1, 'y': 2}}`).

## Access

`v[i]` is an element of an array or a byte of a string, `s.m` a member of a struct, `v.length` the length of an array or
string. A member of an array of structs, `points.x`, is the array of all these members.

## Operators

An operator with a greater number binds tighter. `===` and `!==` mean `==` and `!=`. The unary operators, before a
value, are {unary}. `test ? a : b` gives `a` if `test` is true, else `b`.

| operator | kind | binds |
| --- | --- | --- |
{binary}

`/` always gives a real number. Integers have no bounds in the model, whatever their type.

## Functions

| function | value |
| --- | --- |
{functions}
"""


def properties() -> str:
    schema = json.loads(schema_path("jani-properties.schema.json").read_text(encoding="utf-8"))
    lines = ["# Properties\n", schema["description"] + "\n"]
    for name, definition in schema["$defs"].items():
        title = definition.get("title", name)
        lines.append(f"## {title}\n\n{definition.get('description', '').strip()}\n")
        members = definition.get("properties", {})
        if members:
            required = set(definition.get("required", ()))
            lines += ["| key | required | meaning |", "| --- | --- | --- |"]
            for key, member in members.items():
                text = re.sub(r"\s+", " ", cell(member.get("description", "")))
                lines.append(f"| `{key}` | {'yes' if key in required else ''} | {text} |")
            lines.append("")
    return "\n".join(lines)


def rules() -> str:
    """An index of the documents of the rules, by subject."""
    parts = [RULES_TEXT]
    for group in GROUPS:
        purpose = importlib.import_module(f"roaml.rules.{group}").__doc__ or ""
        parts += [
            f"\n## {group.capitalize()}\n\n{purpose}\n",
            "| code | severity | what is wrong |",
            "| --- | --- | --- |",
        ]
        for rule in RULES:
            file = document_file(rule.code)
            if file.parent.name == group:
                link = f"../../{file.relative_to(ROOT).as_posix()}"
                parts.append(f"| [{rule.code}]({link}) | {rule.severity.label} | {rule.summary} |")
    return "\n".join(parts) + "\n"


def all_rules() -> str:
    """The documents of all rules on one page, for those who print or search it."""
    return "# Rules\n\n" + "\n".join(demoted(in_reference(document(rule.code))) for rule in RULES)


RULES_TEXT = """# Rules

Each finding has a code. `as2fm-lsp --explain CODE` prints the document of a rule, which the code links to here. A
comment `<!-- as2fm: ignore[code] -->` suppresses a rule: on the line of the comment or, if it is alone on its line, in
the element that follows. `python docs/build.py --rules FILE` writes all documents to one page.

A fix is a change that an editor offers. Some fixes are *safe*: they remove nothing that has an effect and do not
guess. `as2fm-lsp --check PATH --fix` applies all safe fixes and reports the remaining findings; in an editor, the
code action `source.fixAll.as2fm` does so for one file, for example when it is saved. All other fixes need a review:
an editor applies the preferred one with its key for fixes, and all preferred ones of a rule with *Fix all ... in this
file*. A safe fix is not applied if it would cause an error, alone or together with others.

An editor also offers these refactorings:

- *Create the plugin*: a file for a node of the tree that has no plugin, with the ports that the node sets, listed in
  the system;
- *Handle all results* of an action, in a state of a machine that sends goals;
- *Add `<bt_halt>`* to a state that takes ticks, or to all of them;
- *Write the node in its compact form*, `<X/>`, or in its explicit form, `<Action ID="X"/>`; or all nodes of a file;
- *Convert the system to the current dialect*, as `as2fm-lsp migrate` does."""


def demoted(text: str) -> str:
    """A document as a section: its headings one level down, those in code left alone."""
    lines = []
    code = False
    for line in text.splitlines():
        code = code != line.startswith("```")
        lines.append(f"#{line}" if line.startswith("#") and not code else line)
    return "\n".join(lines) + "\n"


def command_line() -> str:
    """Not argparse's own layout, which differs between versions of Python."""
    rows = [f"| `{name}` | {summary} |" for name, summary in COMMANDS.items()]
    lines = ["# Command line\n", "| command | what it does |", "| --- | --- |", *rows, "", EXAMPLES_TEXT]
    lines.append("`check`, `explain` and `serve` take the options below without `--check` and `--explain`.\n")
    for group in parser()._action_groups:
        title = "General" if group.title in ("options", "positional arguments") else str(group.title).capitalize()
        lines += options(title, group._group_actions)
    for command in (compare, debug, draw, experiment, explain, init, layout, migrate, simulate, translate, verify):
        subparser = command.parser()
        lines += options(f"`{subparser.prog}`", subparser._actions, f"{subparser.description}\n")
    return "\n".join(lines)


def options(title: str, actions: Iterable[argparse.Action], text: str = "") -> list[str]:
    """A section with a table; empty if there are no options."""
    rows = [option(action) for action in actions if action.dest != "help"]
    head = [f"## {title}\n", *filter(None, [text]), "| option | meaning |", "| --- | --- |"]
    return [*head, *rows, ""] if rows else []


def option(action: argparse.Action) -> str:
    names = ", ".join(action.option_strings) or str(action.metavar)
    value = action.metavar if action.option_strings and action.nargs != 0 else None
    if action.choices and value is None:
        value = "|".join(str(choice) for choice in action.choices)
    shown = f"{names} {value}" if value else names
    return f"| `{cell(shown)}` | {cell(action.help or '')} |"


EXAMPLES_TEXT = f"```text\n{EXAMPLES}```\n"


def cell(text: str) -> str:
    return text.replace("|", "\\|")


def drifted() -> Iterator[Path]:
    """Pages that are missing, differ, or should not be there."""
    expected = pages()
    for name, text in expected.items():
        path = REFERENCE / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            yield path
    yield from (path for path in REFERENCE.glob("*") if path.name not in expected)


def update_schema(check: bool) -> bool:
    """Write the nodes of the schema of trees, or only compare them; whether they were current."""
    path = schema_path(BEHAVIOR_TREE.schema)
    before = path.read_text(encoding="utf-8")
    after = node_schema.with_nodes(before)
    if before != after and not check:
        path.write_text(after, encoding="utf-8")
    return before == after


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--check", action="store_true", help="write nothing; exit with 1 if a page has drifted")
    arguments.add_argument("--rules", metavar="FILE", type=Path, help="write the documents of all rules to a file")
    options_given = arguments.parse_args()
    if options_given.rules:
        options_given.rules.write_text(all_rules(), encoding="utf-8")
        return 0
    is_check = options_given.check
    # Each is read when the program starts, and the next one follows from it.
    steps = (lambda: not update(libraries(), check=is_check), lambda: update_schema(is_check))
    if not all(step() for step in (*steps, lambda: not update(grammars(), check=is_check))):
        if not is_check:
            return subprocess.run([sys.executable, *sys.argv], check=False).returncode
        print("the tables or the schema of trees have drifted", file=sys.stderr)
        return 1
    stale = list(drifted())
    if is_check:
        for path in stale:
            print(f"{path.relative_to(HERE.parent)} is not what docs/build.py writes", file=sys.stderr)
        return 1 if stale else 0
    REFERENCE.mkdir(exist_ok=True)
    expected = pages()
    for path in stale:
        if path.name in expected:
            path.write_text(expected[path.name], encoding="utf-8")
        else:
            path.unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
