# SPDX-License-Identifier: Apache-2.0
"""The rule `never-succeeds`, which never_succeeds.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import rename_tag
from roaml.forest.forest import CPP, Forest
from roaml.forest.ports import ports_of
from roaml.forest.statuses import statuses_of
from roaml.libraries.programs.statuses import FAILURE, SUCCESS
from roaml.model.machine import CallChild, ReturnStatus, RosSend, bodies
from roaml.model.tree import PortSetting, TreeNode
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule, TreeContext, replacements
from roaml.rules.support.answers import plugins
from roaml.rules.support.forest import trees_of
from roaml.rules.support.settings import integer_of
from roaml.rules.support.words import DUMMY, NEGATIVE, words_of

_FAILING = ("AlwaysFailure", "ForceFailure")
_SEQUENCES = ("Sequence", "AsyncSequence", "SequenceWithMemory")
_ENDLESS = "KeepRunningUntilFailure"
_THRESHOLDS = ("success_count", "success_threshold")


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    possible = statuses_of(forest)
    for _, node in forest.own_nodes:
        if _is_library_node(forest, node, "Parallel") and node.children:
            statuses, needed = possible.statuses(node), _needed(node)
            failing = [child for child in node.children if SUCCESS not in statuses[child].ever]
            if needed is not None and len(node.children) - len(failing) < needed <= len(node.children) and failing:
                yield _of_parallel(node, failing, needed)
    for tree in context.file.trees:
        name = tree.id.value if tree.id else ""
        if name in forest.executed and len(tree.roots) == 1 and not _is_intended(forest, name, tree.roots[0]):
            yield from _of_tree(forest, tree.roots[0])


def check_machine(context: MachineContext) -> Iterator[Finding]:
    """Report a plugin of the tree that returns FAILURE in one place and SUCCESS in none, and a server that ends the
    goals of an action in one place, as aborted."""
    words = words_of(context.machine.name.value) if context.machine.name is not None else []
    if context.system is None or not context.automata or context.gaps or not (NEGATIVE | DUMMY).isdisjoint(words):
        return
    statements = [statement for chart in context.machine.charts for statement in chart.statements]
    # Beside an alternative, the answer of the other one may be missing, which other rules report.
    alone = {
        statement.element
        for chart in context.machine.charts
        for _, handler, body in bodies(chart)
        for statement in body
        if handler is None or len(handler.targets) == 1
    }
    returned = [(s, s.status) for s in statements if isinstance(s, ReturnStatus) and s.status is not None]
    failing = [(statement, status) for statement, status in returned if status.value == "FAILURE"]
    calls = any(isinstance(statement, CallChild) for statement in statements)
    is_known = {status.value for _, status in returned} == {"FAILURE", "RUNNING"}  # one that only fails is a dummy
    if plugins(context) and not calls and len(failing) == 1 and is_known and failing[0][0].element in alone:
        span = failing[0][1].span
        message = "the plugin returns FAILURE here and SUCCESS nowhere; did you mean `SUCCESS`?"
        yield RULE.at(span, message, *replacements(span, ("SUCCESS",)))
    handlers = (handler for chart in context.machine.charts for state in chart.states for handler in state.handlers)
    if all(handler.trigger in (None, ProtocolPart.GOAL, ProtocolPart.CANCEL) for handler in handlers):
        return  # a dummy, too
    results: dict[str, list[RosSend]] = {}
    for statement in statements:
        if isinstance(statement, RosSend) and statement.part is ProtocolPart.RESULT and statement.handle is not None:
            results.setdefault(statement.handle.value, []).append(statement)
    for handle, sent in results.items():
        aborting = [statement for statement in sent if statement.element.name == _ABORT]
        if any(statement.element.name == _SUCCEED for statement in sent):
            continue
        if len(aborting) == 1 and aborting[0].element in alone:
            message = f"the goals of `{handle}` are aborted here, and none succeeds; did you mean `<{_SUCCEED}>`?"
            yield RULE.at(aborting[0].element.name_span, message, rename_tag(aborting[0].element, _SUCCEED))


_SUCCEED, _ABORT = "ros_action_succeed", "ros_action_aborted"


def _is_intended(forest: Forest, name: str, root: TreeNode) -> bool:
    """Whether another tree uses a tree that ends with a node that always fails: it reports a failure, for example."""
    is_used = any(name in used for user, used in forest.subtrees.items() if user != name)
    is_sequence = any(_is_library_node(forest, root, sequence) for sequence in _SEQUENCES)
    last = root.children[-1] if root.children else root
    return is_used and is_sequence and any(_is_library_node(forest, last, failing) for failing in _FAILING)


def _threshold(node: TreeNode) -> PortSetting | None:
    return next((setting for setting in ports_of(node) if setting.attribute.name in _THRESHOLDS), None)


def _needed(node: TreeNode) -> int | None:
    """The number of successes that a `Parallel` needs; `None` if it is not a constant."""
    setting = _threshold(node)
    number = integer_of(setting.value.value) if setting is not None else -1
    return None if number is None else number if number >= 0 else len(node.children) + number + 1


def _of_parallel(node: TreeNode, failing: list[TreeNode], needed: int) -> Finding:
    setting = _threshold(node)
    span = setting.value.span if setting is not None else node.element.name_span
    able = len(node.children) - len(failing)
    message = (
        f"`{node.type_name}` never returns SUCCESS: it needs {needed} successes, and only {able} of its children can "
        "succeed; lower the threshold, or change a child"
    )
    return RULE.at(span, message, related=[Related(child.element.name_span, "never succeeds") for child in failing])


def _of_tree(forest: Forest, root: TreeNode) -> Iterator[Finding]:
    """Report a node that always fails, because of which the whole tree never succeeds."""
    possible = statuses_of(forest)
    statuses = possible.statuses(root)
    if SUCCESS in statuses[root].ever or FAILURE not in statuses[root].ever or any(possible.unreached(root)):
        return
    failing = [node for node in statuses if any(_is_library_node(forest, node, name) for name in _FAILING)]
    if any(node.type_name == _ENDLESS for node in statuses) or not failing or root in failing:
        return
    able = [child for child in root.children if SUCCESS in statuses[child].ever]
    if able:
        message = f"the tree never returns SUCCESS, because this `{failing[0].type_name}` always fails"
        related = [Related(root.element.name_span, f"needs a success below this `{root.type_name}`")]
        yield RULE.at(failing[0].element.name_span, message, related=related)


def _is_library_node(forest: Forest, node: TreeNode, name: str) -> bool:
    return node.type_name == name and forest.known_node(node) is CPP.nodes[name]


RULE = Rule(
    "never-succeeds",
    Severity.WARNING,
    "A tree, a `Parallel`, a plugin or an action never succeeds.",
    machine=check_machine,
    tree=check,
    whole=True,
)
