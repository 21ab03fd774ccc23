# SPDX-License-Identifier: Apache-2.0
"""Expands a system file, and the files that it lists."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from roaml.diagnostics import Symbol
from roaml.expansion.declarations import (
    CHANNELS,
    PARAM,
    PARAMETER,
    SECTIONS,
    SETTING,
    Declared,
    Given,
    declaration_elements,
    declarations,
    has_channels,
    values,
)
from roaml.expansion.files import FileExpander, expand_draws
from roaml.expansion.instances import (
    REMAP,
    ListedInstance,
    in_tree,
    instances,
    removed,
    removed_attribute,
    report_unused,
)
from roaml.expansion.namespaces import report_equal, report_inconsistent, report_repeated
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.result import SystemExpansion
from roaml.expansion.state import ExpansionState, named, relative
from roaml.expansion.text import expanded_text
from roaml.expansion.uses import ParameterUses
from roaml.expansion.values import Scope
from roaml.language import SYSTEM
from roaml.model.kinds import FileKind
from roaml.model.syntax import Name
from roaml.model.system_file import TREE_ATTRIBUTE
from roaml.roles import SymbolKind
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Document


class SystemExpander:
    """Expands a system file and the files that it lists."""

    def __init__(self, state: ExpansionState) -> None:
        self.state = state
        self.files = FileExpander(state)
        self.document = state.document
        self._has_instances = False

    def expansion(self) -> SystemExpansion:
        state, document = self.state, self.document
        problems = state.problems_of(state.path)
        declared = state.declared = declarations(document, problems)
        given = {name: Given(text, None, SETTING) for name, text in state.given.items() if "." not in name}
        scope = values(declared, given, {}, problems, varied=state.varied)
        state.settable |= {parameter.name.value for parameter in declared}
        state.note_declarations(state.path, document, declared, scope)
        listed = list(instances(document, problems))
        report_repeated(listed, problems)
        report_inconsistent(listed, problems)
        report_equal(listed, self._declared, problems)
        edits = list(self._system_edits(scope))
        trees = [instance for instance in listed if instance.is_tree]
        edits += self._listed_edits(listed, trees, scope)
        executing = self._trees_of_files(trees)
        expanded = {state.target(instance) for instance in listed if not instance.is_tree}
        for other in state.others:
            if other not in expanded:
                self.files.expand(other, other, None, scope, executing.get(other, ()))
        self._report_trees(trees, problems)
        if has_channels(document):
            from roaml.expansion.system_channels import expand_channels  # noqa: PLC0415 - few systems have channels

            edits += expand_channels(state, document, scope)
        expand_draws(state)
        state.report_unused(state.path, document, declared, state.used)
        if edits:
            state.texts[state.path] = expanded_text(state.path, state.path, document.text, edits)
        return state.result(scope)

    def _listed_edits(
        self, listed: Sequence[ListedInstance], trees: Sequence[ListedInstance], scope: Scope
    ) -> Iterator[TextEdit]:
        """Expand the listed files except `trees`. The edits replace what plain system files do not have."""
        count = Counter(map(self.state.target, listed))
        for instance in listed:
            if instance.is_tree:
                yield from self._plain_input(instance)
                self._note_tree(instance.name, instance, defines=True)
                continue
            for tree in trees:
                if instance.tree is not None and named(tree) == instance.tree.value:
                    self._note_tree(instance.tree, tree, defines=False)
            target = self.state.target(instance)
            if instance.is_plugin and any(tree.changes_files for tree in trees):
                yield from self._plugin(instance, trees, scope, is_again=count[target] > 1)
                continue
            if instance.name is not None:
                symbol = Symbol(target, SymbolKind.MACHINE, instance.name.value)
                self.state.note_place(self.state.path, symbol, instance.name.span, defines=True)
            is_copied = count[target] > 1 and (instance.name is not None or instance.params)
            new = self.state.fresh(target, instance) if is_copied else target
            self.files.expand(target, new, instance, scope)
            if new != target:
                yield TextEdit(instance.src.value_span, relative(new, instance.src.value))
            yield from self._plain_input(instance)

    def _plugin(
        self, plugin: ListedInstance, trees: Sequence[ListedInstance], scope: Scope, *, is_again: bool
    ) -> Iterator[TextEdit]:
        """Expand a plugin for each tree to which it belongs. The input is replaced by one for each of them. `is_again`
        tells whether the system lists the file several times."""
        owners = [tree for tree in trees if plugin.tree is None or named(tree) == plugin.tree.value]
        target = self.state.target(plugin)
        own = {parameter.name.value for parameter in self._declared(plugin)}
        inputs = []
        for tree in owners or [plugin]:
            instance = in_tree(plugin, tree, own) if tree is not plugin else plugin
            is_copied = len(owners) > 1 or (is_again and bool(owners))
            new = self.state.fresh(target, instance) if is_copied and instance.changes_files else target
            self.files.expand(target, new, instance, scope)
            inputs.append((relative(new, plugin.src.value), named(tree)))
            self.state.set_by_trees |= {name for name, _ in tree.params if name.value in own}
            self.state.plugin_parameters |= dict.fromkeys(own, target)
        if len(owners) < 2:
            if inputs[0][0] != plugin.src.value:
                yield TextEdit(plugin.src.value_span, inputs[0][0])
            yield from self._plain_input(plugin)
            return
        type_ = plugin.element.get("type")
        kind = f'type="{type_.value}" ' if type_ is not None else ""
        texts = (f'<input {kind}src="{src}" {TREE_ATTRIBUTE}="{tree}" />' for src, tree in inputs)
        yield TextEdit(plugin.element.span, "\n        ".join(texts))

    def _declared(self, instance: ListedInstance) -> Sequence[Declared]:
        """The parameters of the machine that an input lists; none for other files."""
        target, sources = self.state.target(instance), self.state.sources
        source = sources.document(target) if sources.kind(target) is FileKind.MACHINE else None
        return () if source is None else declarations(source, Problems())

    def _note_tree(self, name: Name | None, tree: ListedInstance, *, defines: bool) -> None:
        """Record a place with the name of a tree."""
        if name is not None:
            symbol = Symbol(self.state.target(tree), SymbolKind.MACHINE, name.value)
            self.state.note_place(self.state.path, symbol, name.span, defines=defines)

    def _report_trees(self, trees: Sequence[ListedInstance], problems: Problems) -> None:
        """Report the values and the remaps of trees that have no effect on their plugins, and that AS2FM executes only
        one tree."""
        for tree in trees:
            for name, _ in tree.params:
                if name not in self.state.set_by_trees:
                    message = f"no plugin of this tree has a parameter `{name.value}`, and none of its files uses it"
                    problems.add(ExpansionProblem.UNKNOWN, name.span, message)
            report_unused(tree.remaps, self.state.remapped, problems)
        if len(trees) > 1:
            message = "AS2FM executes only one tree, so it cannot read this system"
            self.state.not_in_reference(self.state.path, trees[1].element.name_span, message)

    def _system_edits(self, scope: Scope) -> Iterator[TextEdit]:
        document, problems = self.document, self.state.problems_of(self.state.path)
        uses = ParameterUses(document, SYSTEM, scope, problems, frozenset())
        self.state.note_system_uses(uses.uses)
        yield from uses.edits
        for element in declaration_elements(document):
            yield removed(document, element)
        for section in document.root.elements if document.root else ():
            if section.name in (SECTIONS[0], CHANNELS):
                yield removed(document, section)
        self._reference(document)

    def _reference(self, document: Document) -> None:
        """Report the first part that AS2FM ignores or rejects."""
        ending = "`as2fm-lsp translate --expand DIR` writes the system without parameters and instances"
        for section in document.root.elements if document.root else ():
            inside = section.elements if section.name in SECTIONS[1:] else ()
            rejected = next((element for element in inside if element.name == PARAMETER), None)
            if rejected is not None:
                message = f"AS2FM rejects `<{PARAMETER}>` in `<{section.name}>`; {ending}"
                self.state.not_in_reference(self.state.path, rejected.name_span, message)
                return
            if section.name in (SECTIONS[0], PARAMETER):
                message = f"AS2FM ignores `<{section.name}>`, so it cannot read what uses the parameters; {ending}"
                self.state.not_in_reference(self.state.path, section.name_span, message)
                return

    def _plain_input(self, instance: ListedInstance) -> Iterator[TextEdit]:
        """The edits that remove from an input what plain system files do not have."""
        element = instance.element
        if instance.is_plain:
            return
        first = next(iter(element.elements), None)
        place = first.name_span if first is not None else element.name_span
        for name in ("namespace",) if instance.is_tree else ("name", "namespace"):
            if (attribute := element.get(name)) is not None:
                place = attribute.name_span
                yield removed_attribute(self.document, attribute)
        extra = [child for child in element.elements if child.name in (PARAM, REMAP)]
        if extra and len(extra) == len(element.elements) and element.close_span is not None:
            yield TextEdit(Span(element.open_span.end - 1, element.span.end), " />")
        else:
            for child in extra:
                yield removed(self.document, child)
        if self._has_instances:
            return
        self._has_instances = True
        message = (
            "AS2FM ignores the name, the namespace, the parameters and the remaps of an input; "
            "`as2fm-lsp translate --expand DIR` writes a file for each instance"
        )
        self.state.not_in_reference(self.state.path, place, message)

    def _trees_of_files(self, trees: Sequence[ListedInstance]) -> dict[str, list[ListedInstance]]:
        """The path of a file of trees -> the trees that a system executes with it: of one that sets values, all that
        list or include the file."""
        executing: dict[str, list[ListedInstance]] = {}
        for tree in trees if any(tree.params for tree in trees) else ():
            pending, known = [self.state.target(tree)], set[str]()
            while pending:
                path = pending.pop()
                is_new = path not in known and path in self.state.others
                document = self.state.sources.document(path) if is_new else None
                known.add(path)
                if document is None or document.root is None:
                    continue
                executing.setdefault(path, []).append(tree)
                includes = (child.get("path") for child in document.root.elements if child.name == "include")
                pending += (self.state.resolve(path, name.value) for name in includes if name is not None)
        return executing
