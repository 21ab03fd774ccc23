# SPDX-License-Identifier: Apache-2.0
"""Instances: files that a system lists with a name, a namespace, values of parameters and remaps
(docs/spec/parameters.md#instances)."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Container, Iterable, Iterator, Set

from roaml.expansion.declarations import PARAM
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.language import HL_SCXML
from roaml.model.build_machine import INTERFACE_ATTRIBUTES
from roaml.model.kinds import FileKind
from roaml.model.syntax import Name, name_of
from roaml.model.system_file import TREE_ATTRIBUTE, SystemInput, SystemSection, required_kind
from roaml.record import Record, replace
from roaml.regex import regex
from roaml.roles import SymbolKind
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Attribute, Document, Element

REMAP = "remap"
_NAME = regex(r"[A-Za-z_]\w*\Z", re.ASCII)
_NAMESPACE = regex(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*/?\Z", re.ASCII)


class Remap(Record, frozen=True, eq=False):
    """A `<remap>`: the interface or event `old` of the file is called `new`."""

    element: Element
    old: Name
    new: Name


class ListedInstance(Record, frozen=True, eq=False):
    """An `<input>` that lists a file.

    Attributes:
        name: the name of the instance; `None` if the file keeps its own.
        namespace: the namespace of relative names; "" if there is none.
        params: name of a parameter of the file -> its value in the system file; those of a tree are parameters of its
            plugins.
        src: the attribute with the path of the file.
        tree: for a plugin, the name of the tree to which it belongs; `None` if it belongs to all trees.
    """

    element: Element
    section: SystemSection
    src: Attribute
    name: Name | None
    namespace: str
    params: tuple[tuple[Name, Attribute], ...]
    remaps: tuple[Remap, ...]
    tree: Name | None = None

    @property
    def is_tree(self) -> bool:
        return is_tree(self.element, self.section)

    @property
    def is_plugin(self) -> bool:
        return self.section is SystemSection.BEHAVIOR_TREE and not self.is_tree

    @property
    def changes_files(self) -> bool:
        """Whether the input has a namespace, values of parameters or remaps."""
        return bool(self.namespace or self.params or self.remaps)

    @property
    def is_plain(self) -> bool:
        """Whether the input uses nothing that is expanded."""
        extra = any(child.name in (PARAM, REMAP) for child in self.element.elements)
        return not extra and all(self.element.get(name) is None for name in ("name", "namespace", TREE_ATTRIBUTE))


def is_tree(element: Element, section: SystemSection) -> bool:
    """Whether an input lists a tree."""
    return required_kind(SystemInput(element, section, name_of(element.get("type")), None)) is FileKind.TREE


def in_tree(plugin: ListedInstance, tree: ListedInstance, declared: Container[str]) -> ListedInstance:
    """The copy of a plugin for a tree, with the namespace, the remaps and the values of parameters of the tree.

    Args:
        declared: the parameters that the plugin declares.
    """
    own = {name.value for name, _ in plugin.params}
    params = (p for p in tree.params if p[0].value in declared and p[0].value not in own)
    return replace(
        plugin,
        namespace=tree.namespace,
        params=(*plugin.params, *params),
        remaps=(*plugin.remaps, *tree.remaps),
        tree=tree.name,
    )


def instances(document: Document, problems: Problems) -> Iterator[ListedInstance]:
    """The inputs of a system file that name a file."""
    for section in document.root.elements if document.root else ():
        if section.name not in {member.value for member in SystemSection}:
            continue
        for element in section.elements:
            src = element.get("src")
            if element.name == "input" and src is not None and src.value:
                yield _instance(element, SystemSection(section.name), src, problems)


def _instance(element: Element, section: SystemSection, src: Attribute, problems: Problems) -> ListedInstance:
    if "$(var" in src.value:
        message = "a path cannot contain a parameter, because the files of a system are the same for all values"
        problems.add(ExpansionProblem.INSTANCE, src.value_span, message)
    name = name_of(element.get("name"))
    if name is not None and not _NAME.match(name.value):
        message = (
            f"`{name.value}` cannot be the name of an instance; use letters, digits and underscores, not beginning "
            "with a digit"
        )
        problems.add(ExpansionProblem.INSTANCE, name.span, message)
        name = name if is_tree(element, section) else None  # the plugins of a tree still refer to it
    given = name_of(element.get("namespace"))
    namespace = given.value.strip("/") if given is not None else ""
    if given is not None and not _NAMESPACE.match(given.value) and given.value != "/":
        message = f"`{given.value}` is not a namespace of ROS; write names separated by `/`, such as `/robots/first`"
        problems.add(ExpansionProblem.INSTANCE, given.span, message)
        namespace = ""
    if section is not SystemSection.NODE_MODELS and not is_tree(element, section):
        for attribute in (element.get("name"), element.get("namespace")):
            if attribute is not None:
                message = (
                    f"`{attribute.name}` has an effect only on inputs of `<node_models>` and on trees; remove the "
                    "attribute, or set a parameter of the file with `<param>`"
                )
                problems.add(ExpansionProblem.INSTANCE, attribute.name_span, message)
        name, namespace = None, ""
    params, remaps = tuple(_params(element, problems)), tuple(_remaps(element, problems))
    tree = name_of(element.get(TREE_ATTRIBUTE))
    return ListedInstance(element, section, src, name, namespace, params, remaps, tree)


def _params(element: Element, problems: Problems) -> Iterator[tuple[Name, Attribute]]:
    seen: set[str] = set()
    for child in element.elements:
        if child.name != PARAM:
            continue
        name, value = name_of(child.get("name")), child.get("value")
        if name is None or value is None:
            problems.add(ExpansionProblem.INSTANCE, child.name_span, "`<param>` needs a `name` and a `value`")
        elif name.value in seen:
            message = f"the parameter `{name.value}` is set twice; remove one of the elements"
            problems.add(ExpansionProblem.INSTANCE, name.span, message)
        else:
            seen.add(name.value)
            yield name, value


def _remaps(element: Element, problems: Problems) -> Iterator[Remap]:
    for child in element.elements:
        if child.name != REMAP:
            continue
        old, new = name_of(child.get("from")), name_of(child.get("to"))
        if old is None or new is None:
            problems.add(ExpansionProblem.INSTANCE, child.name_span, "`<remap>` needs the attributes `from` and `to`")
        else:
            yield Remap(child, old, new)


class InstanceNames:
    """The names of topics, services, actions and events of an instance."""

    def __init__(self, instance: ListedInstance, node: str) -> None:
        self._instance = instance
        self._node = instance.name.value if instance.name else node
        self._by_name = {self._full(remap.old.value): remap for remap in reversed(instance.remaps)}
        self._by_event = {remap.old.value: remap for remap in reversed(instance.remaps)}
        self.used: set[Remap] = set()

    def _full(self, name: str) -> str:
        """The full name of a topic, service or action, with a leading `/`, by the rules of ROS 2."""
        if name.startswith("/"):
            return name
        if name.startswith("~"):
            return posixpath.join("/", self._instance.namespace, self._node, name[1:].lstrip("/"))
        return posixpath.join("/", self._instance.namespace, name)

    def interface(self, name: str) -> str:
        """The name of a topic, service or action in this instance. Without a namespace and remaps, it is unchanged."""
        remap = self._by_name.get(self._full(name))
        if remap is not None:
            self.used.add(remap)
            return self._full(remap.new.value) if self._instance.namespace else remap.new.value
        return self._full(name) if self._instance.namespace or name.startswith("~") else name

    def event(self, name: str) -> str:
        remap = self._by_event.get(name)
        if remap is None:
            return name
        self.used.add(remap)
        return remap.new.value


def instance_edits(document: Document, instance: ListedInstance, used: set[Remap]) -> Iterator[TextEdit]:
    """The edits that give a machine the name, the namespace and the remaps of an instance.

    Args:
        used: receives the remaps that have an effect.
    """
    root = document.root
    if root is None:
        return
    own = root.get("name")
    if instance.name is not None and own is not None:
        yield TextEdit(own.value_span, instance.name.value)
    if instance.name is None and not instance.namespace and not instance.remaps:
        return
    names = InstanceNames(instance, own.value if own else "")
    for element in root.walk():
        yield from interface_edits(document, element, names.interface)
        type_ = HL_SCXML.elements.get(element.name)
        for attribute in element.attributes if type_ is not None else ():
            role = type_.attributes.get(attribute.name) if type_ is not None else None
            if role is not None and (role.defines is SymbolKind.EVENT or SymbolKind.EVENT in role.refers):
                event = attribute.value.strip()
                if event and names.event(event) != event:
                    yield TextEdit(attribute.value_span, names.event(event))
    used |= names.used


def interface_edits(document: Document, element: Element, renamed: Callable[[str], str]) -> Iterator[TextEdit]:
    """The edits that rename the topic, service or action that an element declares. The handle of a declaration without
    a `name` is the name of the interface (docs/spec/ros.md#handles), so it gets this name.

    Args:
        renamed: the name of an interface -> its new name.
    """
    if element.name not in HL_SCXML.groups["Declaration"]:
        return
    for name in INTERFACE_ATTRIBUTES:
        attribute, child = element.get(name), element.find(name)
        if attribute is not None:
            written, span = attribute.value.strip(), attribute.value_span
        elif child is not None and (content := document.content(child)) is not None:
            written, span = content.text.strip(), content.span(0, len(content.text))
        else:
            continue
        new = renamed(written) if written else written
        if new != written:
            yield TextEdit(span, new)
            if element.get("name") is None:
                handle = document.text[span.start : span.end].strip().replace('"', "&quot;")
                yield TextEdit(Span(element.name_span.end, element.name_span.end), f' name="{handle}"')


def report_unused(remaps: Iterable[Remap], used: Set[Remap], problems: Problems) -> None:
    """Report the remaps that have no effect, as problems of the system file."""
    for remap in remaps:
        if remap not in used:
            message = f"the file has no topic, service, action or event `{remap.old.value}`, so the remap has no effect"
            problems.add(ExpansionProblem.REMAP, remap.old.span, message)


def removed(document: Document, element: Element) -> TextEdit:
    """The edit that removes an element; with its line if nothing else is in it."""
    text, start, end = document.text, element.span.start, element.span.end
    line_start = text.rfind("\n", 0, start) + 1
    line_end = text.find("\n", end)
    line_end = len(text) if line_end < 0 else line_end + 1
    if not text[line_start:start].strip() and not text[end:line_end].strip():
        return TextEdit(Span(line_start, line_end), "")
    return TextEdit(element.span, "")


def removed_attribute(document: Document, attribute: Attribute) -> TextEdit:
    """The edit that removes an attribute and the white space before it."""
    start = attribute.span.start
    while start > 0 and document.text[start - 1].isspace():
        start -= 1
    return TextEdit(Span(start, attribute.span.end), "")
