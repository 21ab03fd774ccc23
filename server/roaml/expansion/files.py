# SPDX-License-Identifier: Apache-2.0
"""Expands a file of a system: a machine, properties or trees."""

from __future__ import annotations

import functools
import json
from collections.abc import Sequence

from roaml.distributions import calls_distribution
from roaml.expansion.declarations import SETTING, Declared, Given, declarations, values
from roaml.expansion.instances import ListedInstance, instance_edits, removed, report_unused
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.state import ExpansionState, named
from roaml.expansion.text import ExpandedText, expanded_text
from roaml.expansion.uses import VARIABLE, ParameterUses, uses_in
from roaml.expansion.values import ParameterValue, Scope
from roaml.expr.types import ScalarKind
from roaml.jani.properties import identifiers
from roaml.model.kinds import GRAMMARS, FileKind
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean, listing
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Attribute, Document

_LITERAL = regex(r"(?:-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][-+]?\d+)?|true|false)\Z")
"""A number or boolean in JSON."""


class FileExpander:
    """Expands the files that a system lists."""

    def __init__(self, state: ExpansionState) -> None:
        self.state = state

    def expand(
        self,
        source: str,
        path: str,
        instance: ListedInstance | None,
        scope: Scope,
        trees: Sequence[ListedInstance] = (),
    ) -> None:
        """Expand a file. `trees` are the trees that are executed with a file of trees, if these set values."""
        kind = self.state.sources.kind(source)
        if kind is FileKind.PROPERTIES:
            self._expand_jani(source, path, instance, scope)
            return
        document = self.state.sources.document(source) if kind in GRAMMARS else None
        if document is None or document.root is None:
            return
        edits = self._parameter_edits(source, kind, document, instance, scope, trees)
        if kind is FileKind.MACHINE:
            self.state.machines[path] = source
            if instance is not None:
                edits = [*self._instance_edits(source, document, instance), *edits]
            if instance is not None and instance.namespace:
                self.state.namespaces[path] = instance.namespace
        text = expanded_text(path, source, document.text, edits)
        if text.text != document.text or path != source:
            self.state.texts[path] = text

    def _parameter_edits(
        self,
        source: str,
        kind: FileKind,
        document: Document,
        instance: ListedInstance | None,
        of_system: Scope,
        trees: Sequence[ListedInstance],
    ) -> list[TextEdit]:
        """The edits that replace the uses of parameters by their values, and remove their declarations."""
        state, problems = self.state, self.state.problems_of(source)
        of_trees = self._values_of_trees(trees, of_system)
        scope = {**of_system, **of_trees}
        own = declarations(document, problems) if kind in (FileKind.MACHINE, FileKind.XML_PROPERTIES) else ()
        own_values = self._own_values(source, document, instance, own, scope)
        inner = {**{name: value for name, value in scope.items() if name not in own_values}, **own_values}
        uses = ParameterUses(document, GRAMMARS[kind], inner, problems, frozenset(own_values))
        names = {use.name for use in uses.uses} | uses.hidden
        state.used |= names - own_values.keys()
        for use in uses.uses:
            if use.name not in of_trees:
                state.note(source, source if use.name in own_values else state.path, use.name, use.span)
        for name in dict.fromkeys(use.name for use in uses.uses if use.name in of_trees):
            spans = [use.span for use in uses.uses if use.name == name]
            self._note_tree_value(source, name, trees, of_system, spans)
        state.note_declarations(source, document, own, scope)
        state.report_unused(source, document, own, names)
        if own:
            message = (
                "AS2FM ignores `<parameter>`, so it cannot read what uses the parameters; "
                "`as2fm-lsp translate --expand DIR` writes the file without them"
            )
            state.not_in_reference(source, own[0].element.name_span, message)
        return [*uses.edits, *(removed(document, parameter.element) for parameter in own)]

    def _own_values(
        self,
        source: str,
        document: Document,
        instance: ListedInstance | None,
        own: tuple[Declared, ...],
        scope: Scope,
    ) -> dict[str, ParameterValue]:
        """The values of the parameters that a file declares."""
        problems = self.state.problems_of(self.state.path)
        given = self._given(source, instance, own, scope, document, problems)
        # A value from the system file is reported there; the problems of defaults and of `--set` belong to the file.
        from_system = {n: g for n, g in given.items() if g.span is not None}
        if from_system:
            values(tuple(p for p in own if p.name.value in from_system), from_system, scope, problems)
        of_file = Problems() if from_system else self.state.problems_of(source)
        return values(own, given, scope, of_file, varied=self.state.varied)

    def _instance_edits(self, source: str, document: Document, instance: ListedInstance) -> list[TextEdit]:
        """The edits that give an instance of a machine its names."""
        state = self.state
        edits = list(instance_edits(document, instance, state.remapped))
        own_remaps = (remap for remap in instance.remaps if remap.element in instance.element.elements)
        report_unused(own_remaps, state.remapped, state.problems_of(state.path))
        own_name = document.root.get("name") if document.root is not None else None
        spans = [edit.span for edit in edits if own_name is None or edit.span != own_name.value_span]
        names_in_file = (document.decoded(span).text.strip() for span in spans if span.start < span.end)
        state.renamed.setdefault(source, set()).update(names_in_file)
        return edits

    def _given(
        self,
        source: str,
        instance: ListedInstance | None,
        own: tuple[Declared, ...],
        scope: Scope,
        document: Document,
        problems: Problems,
    ) -> dict[str, Given]:
        """The values that the system gives for the parameters of a file, in increasing precedence: a parameter of the
        system with the same name, a `<param>`, and a value from outside."""
        known = {parameter.name.value: parameter for parameter in own}
        given: dict[str, Given] = {}
        for name in known:
            if name in scope:
                self.state.used.add(name)
                given[name] = Given(scope[name].text, None, f"the parameter `{name}` of the system")
        for param, value in instance.params if instance else ():
            if param.value not in known:
                close = close_names(param.value, known)
                src = instance.src.value if instance else ""
                declares = f"; it declares {listing(tuple(known))}" if known else "; it declares no parameters"
                message = f"`{src}` has no parameter `{param.value}`{did_you_mean(close) if close else declares}"
                problems.add(ExpansionProblem.UNKNOWN, param.span, message, close=close)
                continue
            self.state.note(self.state.path, source, param.value, param.span)
            given[param.value] = self._given_by_param(value, known[param.value].type, scope, problems)
        root = document.root
        machine = root.get("name") if root is not None else None
        name = instance.name.value if instance and instance.name else (machine.value.strip() if machine else "")
        for parameter in known:
            names = tuple(filter(None, (name, instance.tree.value if instance and instance.tree else "")))
            self.state.settable |= {f"{name}.{parameter}" for name in names}
            for key in (f"*.{parameter}", *(f"{name}.{parameter}" for name in names)):
                if key in self.state.given:
                    given[parameter] = Given(self.state.given[key], None, SETTING)
                    self.state.of_instances |= {f"{owner}.{parameter}": self.state.given[key] for owner in names[-1:]}
        return given

    def _given_by_param(self, value: Attribute, type_: str, scope: Scope, problems: Problems) -> Given:
        """The value that a `<param>` gives to a parameter of a type."""
        for match in VARIABLE.finditer(value.value):
            if match[1] not in scope:
                message = f"there is no parameter `{match[1]}`; declare it with `<parameter>`"
                problems.add(ExpansionProblem.UNKNOWN, value.value_span, message)
        text = VARIABLE.sub(lambda m: scope[m[1]].text if m[1] in scope else m[0], value.value)
        if type_ != "string" or "$(var" in value.value:
            self.state.note_system_uses(uses_in(self.state.document, value, scope))
        return Given(text, value.value_span, "`<param>`")

    def _undeclared(self, instance: ListedInstance, scope: Scope) -> dict[str, ParameterValue]:
        """The values of the `<param>` of an input whose file cannot declare parameters: those of parameters of the
        system with these names, and texts. Those of trees can be given from outside."""
        problems, given = self.state.problems_of(self.state.path), dict[str, ParameterValue]()
        for param, value in instance.params:
            declared = [parameter for parameter in self.state.declared if parameter.name.value == param.value]
            type_ = declared[0].type if declared else "string"
            of_param = self._given_by_param(value, type_, scope, problems)
            if instance.is_tree and instance.name is not None:
                key = f"{instance.name.value}.{param.value}"
                self.state.settable.add(key)
                if key in self.state.given:
                    of_param = Given(self.state.given[key], None, SETTING)
                    self.state.of_instances |= {key: self.state.given[key]}
            if declared:
                given |= values(tuple(declared), {param.value: of_param}, scope, problems)
            else:
                given[param.value] = ParameterValue("string", of_param.text)
        return given

    def _expand_jani(self, source: str, path: str, instance: ListedInstance | None, scope: Scope) -> None:
        """Expand a file of properties in JANI, which uses the parameters of the system and the `<param>` of its
        input."""
        text = self.state.sources.text(source)
        if text is None:
            return
        problems = self.state.problems_of(source)
        edits: list[TextEdit] = []
        own = {} if instance is None else self._undeclared(instance, scope)
        scope = {**scope, **own}
        used: set[str] = set()
        for declared in self.state.sources.properties(source):
            for name, span in identifiers(declared.expression):
                value = scope.get(name)
                if value is not None and span.end > span.start:
                    used.add(name)
                    self.state.note(source, self.state.owner(source, name), name, span)
                    quoted = Span(span.start - 1, span.end + 1)
                    is_text = value.kind is ScalarKind.STRING and not (name in own and _LITERAL.match(value.text))
                    edits.append(TextEdit(quoted, json.dumps(value.content) if is_text else value.text))
        for match in VARIABLE.finditer(text):
            value = scope.get(match[1])
            if value is None:
                message = (
                    f"there is no parameter `{match[1]}`; declare it in the system file with `<parameter>`, or set it "
                    "with `<param>` in the input of this file"
                )
                problems.add(ExpansionProblem.UNKNOWN, Span(*match.span(1)), message)
            else:
                used.add(match[1])
                self.state.note(source, self.state.owner(source, match[1]), match[1], Span(*match.span(1)))
                edits.append(TextEdit(Span(*match.span()), value.text.replace("\\", "\\\\").replace('"', '\\"')))
        self.state.used |= used
        for param, _ in () if instance is None else instance.params:
            owner = self.state.owner(source, param.value)
            self.state.note(self.state.path, owner, param.value, param.span, defines=owner == source)
            if instance is not None and param.value not in used:
                message = f"`{instance.src.value}` does not use the parameter `{param.value}`; remove it"
                self.state.problems_of(self.state.path).add(ExpansionProblem.UNKNOWN, param.span, message)
        if edits or path != source:
            self.state.texts[path] = expanded_text(path, source, text, edits)

    def _values_of_trees(self, trees: Sequence[ListedInstance], scope: Scope) -> dict[str, ParameterValue]:
        """The values that a file of trees has from the trees that are executed with it: those of the first one that
        sets them."""
        given = [self._undeclared(tree, scope) for tree in trees]
        return {name: value for of_tree in reversed(given) for name, value in of_tree.items()}

    def _note_tree_value(
        self, source: str, name: str, trees: Sequence[ListedInstance], scope: Scope, uses: Sequence[Span]
    ) -> None:
        """Record the uses of a value of trees in the file of trees `source`. The file is one text, so that different
        values are a problem.

        Args:
            scope: the parameters of the system.
            uses: the places of the name in the file.
        """
        written = [param for tree in trees for param, _ in tree.params if param.value == name]
        self.state.set_by_trees |= set(written)
        owner = self.state.plugin_parameters.get(name) or self.state.owner(source, name)
        for param in written:
            self.state.note(self.state.path, owner, name, param.span, defines=owner == source)
        for span in uses:
            self.state.note(source, owner, name, span)
        values_ = [(named(tree), self._undeclared(tree, scope).get(name) or scope.get(name)) for tree in trees]
        first, value = next((tree, value) for tree, value in values_ if value is not None)
        for tree, other in values_:
            if other is not None and other.text == value.text:
                continue
            shown = f"is {other.text}" if other is not None else "has no value"
            message = (
                f"`{name}` is {value.text} in the tree `{first}` and {shown} in the tree `{tree}`, but both execute "
                "this file, which is one text; list a copy of the file with other IDs for one of the trees, or use the "
                "parameter in a plugin, of which each tree has its own"
            )
            for span in uses:
                self.state.problems_of(source).add(ExpansionProblem.VALUE, span, message)
            return


def expand_draws(state: ExpansionState) -> None:
    """Expand the draws of all machines."""
    for path in state.machines:
        text = state.expanded(path)
        if text is not None and calls_distribution(text.text):
            drawn = _with_draws(state, text)
            if drawn is not text:
                state.texts[path] = drawn


def _with_draws(state: ExpansionState, text: ExpandedText) -> ExpandedText:
    from roaml.expansion.draws import expand_draws  # noqa: PLC0415 - few machines draw numbers

    text, numbers = expand_draws(text, state.problems_of(text.source), functools.partial(state.read_data, text.source))
    state.drawn.update(dict.fromkeys(numbers))
    if numbers:
        message = (
            "AS2FM has no distributions; `as2fm-lsp translate --expand DIR` writes targets with probabilities instead"
        )
        state.not_in_reference(text.source, numbers[0].span, message)
    return text
