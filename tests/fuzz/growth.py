# SPDX-License-Identifier: Apache-2.0
"""Small inputs that become large: each dimension in which a system can grow, as a function of its size.

The fuzzer uses them with any size, the benchmarks with a size and ten times this size.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass

from fuzz.corpus import NOWHERE

Files = dict[str, str]

SYSTEM = """<roaml>
    <parameters><max_time value="3" unit="s" />{parameters}</parameters>
    {types}
    {tree}
    <node_models>{nodes}</node_models>
    <properties><input type="jani" src="p.jani" /></properties>
</roaml>
"""
MACHINE = """<ascxml name="M" version="1.0" initial="s">
{head}
<state id="s">{body}</state>
{more}
</ascxml>
"""
PROPERTIES = '{"properties": []}'


def _system(
    machine: str = "", types: str = "", tree: str = "", nodes: str = '<input type="node-ascxml" src="m.ascxml" />',
    parameters: str = "", **files: str,
) -> Files:  # fmt: skip
    files = {name.replace("_", "."): text for name, text in files.items()}
    main = SYSTEM.format(types=types, tree=tree, nodes=nodes, parameters=parameters)
    texts = {"main.xml": main, "p.jani": PROPERTIES, **files}
    return texts | {"m.ascxml": machine} if machine else texts


def _machine(head: str = "", body: str = "", more: str = "") -> str:
    return MACHINE.format(head=head, body=body, more=more)


_TIMER = '<ros_time_rate name="t" rate_hz="1" />'


def _on_tick(body: str) -> str:
    return f'<ros_rate_callback name="t" target="s">{body}</ros_rate_callback>'


# ----------------------------------------------------------------- one machine


def array_bound(n: int) -> Files:
    """One array of n elements."""
    return _system(_machine(f'<datamodel><data id="a" type="int32[{n}]" expr="[]" /></datamodel>'))


def array_dimensions(n: int) -> Files:
    """An array with as many dimensions as n has digits, each of ten elements."""
    return _system(_machine(f'<datamodel><data id="a" type="int32{"[10]" * len(str(n))}" expr="[]" /></datamodel>'))


def array_literals(n: int) -> Files:
    """An array of n / 10 elements that is assigned n / 10 times."""
    body = '<assign location="a" expr="[]" />' * max(1, n // 10)
    head = f'<datamodel><data id="a" type="int32[{max(1, n // 10)}]" expr="[]" /></datamodel>{_TIMER}'
    return _system(_machine(head, _on_tick(body)))


def array_comparisons(n: int) -> Files:
    """Two arrays of n elements that are compared."""
    data = "".join(f'<data id="{name}" type="int32[{n}]" expr="[]" />' for name in "ab")
    return _system(
        _machine(
            f"<datamodel>{data}</datamodel>{_TIMER}",
            _on_tick('<if cond="a == b"><assign location="a" expr="b" /></if>'),
        )
    )


def max_array_size(n: int) -> Files:
    """Strings and arrays without a bound in a system that gives them n elements."""
    data = '<data id="a" type="int32[]" expr="[]" /><data id="b" type="string" expr="\'\'" />'
    head = f"<datamodel>{data}</datamodel>{_TIMER}"
    send = '<send event="e"><param name="a" expr="a" /><param name="b" expr="b" /></send>'
    parameters = f'<max_array_size value="{n}" />'
    receive = '<transition event="e" target="s" />'
    return _system(_machine(head, _on_tick(send) + receive), parameters=parameters)


def branches(n: int) -> Files:
    """An `<if>` with n branches."""
    more = "".join(f'<elseif cond="x == {i}" /><assign location="x" expr="{i}" />' for i in range(n))
    head = f'<datamodel><data id="x" type="int64" expr="0" /></datamodel>{_TIMER}'
    return _system(_machine(head, _on_tick(f'<if cond="x &lt; 0"><assign location="x" expr="0" />{more}</if>')))


def nested_branches(n: int) -> Files:
    """`<if>` in `<if>`, n deep."""
    head = f'<datamodel><data id="x" type="int64" expr="0" /></datamodel>{_TIMER}'
    return _system(
        _machine(head, _on_tick('<if cond="x == 1">' * n + '<assign location="x" expr="2" />' + "</if>" * n))
    )


def transitions(n: int) -> Files:
    """n transitions on one event, each with a condition."""
    body = "".join(f'<transition event="e" cond="x == {i}" target="s" />' for i in range(n))
    head = f'<datamodel><data id="x" type="int64" expr="0" /></datamodel>{_TIMER}'
    return _system(_machine(head, body + _on_tick('<send event="e" />')))


def targets(n: int) -> Files:
    """A transition with n targets."""
    body = "".join(f'<target id="s" prob="{1 / n}" />' for _ in range(n))
    return _system(_machine(_TIMER, f'<ros_rate_callback name="t">{body}</ros_rate_callback>'))


def states(n: int) -> Files:
    """n states in a row."""
    more = "".join(f'<state id="s{i}"><ros_rate_callback name="t" target="s{(i + 1) % n}" /></state>' for i in range(n))
    return _system(_machine(_TIMER, '<ros_rate_callback name="t" target="s0" />', more))


def states_and_events(n: int) -> Files:
    """Many states that ignore many events: n in all."""
    k = max(1, int(n**0.5))
    sends = "".join(f'<send event="e{i}" />' for i in range(k))
    receives = "".join(f'<transition event="e{i}" target="s0" />' for i in range(k))
    more = "".join(f'<state id="s{i}"><transition event="e0" target="s{(i + 1) % k}" /></state>' for i in range(k))
    return _system(_machine(_TIMER, _on_tick(sends) + receives, more))


def variables(n: int) -> Files:
    """n variables."""
    data = "".join(f'<data id="x{i}" type="int32" expr="0" />' for i in range(n))
    return _system(_machine(f"<datamodel>{data}</datamodel>"))


def long_expression(n: int) -> Files:
    """A sum of n terms."""
    head = f'<datamodel><data id="x" type="int64" expr="0" /></datamodel>{_TIMER}'
    return _system(_machine(head, _on_tick(f'<assign location="x" expr="x{" + 1" * n}" />')))


def deep_expression(n: int) -> Files:
    """n brackets."""
    head = f'<datamodel><data id="x" type="int64" expr="0" /></datamodel>{_TIMER}'
    return _system(_machine(head, _on_tick(f'<assign location="x" expr="{"(" * n}x{")" * n}" />')))


def long_string(n: int) -> Files:
    """A string of n characters."""
    head = f'<datamodel><data id="x" type="string" expr="\'{"a" * n}\'" /></datamodel>'
    return _system(_machine(head))


def draws(n: int) -> Files:
    """An expression with as many random numbers as n has digits."""
    head = f'<datamodel><data id="x" type="float64" expr="0.0" /></datamodel>{_TIMER}'
    value = " + ".join(["Math.random()"] * len(str(n)))
    return _system(_machine(head, _on_tick(f'<assign location="x" expr="{value}" />')))


def many_draws(n: int) -> Files:
    """n assignments of random numbers."""
    head = f'<datamodel><data id="x" type="float64" expr="0.0" /></datamodel>{_TIMER}'
    return _system(_machine(head, _on_tick('<assign location="x" expr="Math.random() + Math.random()" />' * n)))


def unknown_attributes(n: int) -> Files:
    """n attributes that do not exist."""
    return _system(_machine(body="<onentry " + " ".join(f'zz{i}="1"' for i in range(n)) + " />"))


def unknown_elements(n: int) -> Files:
    """n elements that do not exist."""
    return _system(_machine(body="<stat />" * n))


def findings_in_a_line(n: int) -> Files:
    """n errors in one line, each of which has a fix."""
    head = f'<datamodel><data id="level" type="int64" expr="0" /></datamodel>{_TIMER}'
    return _system(_machine(head, _on_tick('<assign location="levle" expr="0" />' * n)))


def unknown_variables(n: int) -> Files:
    """n names that are not declared, each similar to one that is declared and not used."""
    data = "".join(f'<data id="level_{i}" type="int32" expr="0" />' for i in range(n))
    body = "".join(f'<assign location="levle_{i}" expr="0" />' for i in range(n))
    return _system(_machine(f"<datamodel>{data}</datamodel>{_TIMER}", _on_tick(body)))


def unknown_states(n: int) -> Files:
    """n targets that do not exist, each similar to the name of a state."""
    state = '<state id="place_{0}"><ros_rate_callback name="t" target="plaec_{0}" /></state>'
    return _system(_machine(_TIMER, more="".join(map(state.format, range(n)))))


def unknown_events(n: int) -> Files:
    """n events that are never received, and n similar ones that are never sent."""
    transitions = "".join(f'<transition event="evnet_{i}" target="s" />' for i in range(n))
    return _system(_machine(_TIMER, transitions + _on_tick("".join(f'<send event="event_{i}" />' for i in range(n)))))


def unknown_topics(n: int) -> Files:
    """n topics without subscribers, and n similar ones without publishers, in one machine."""
    topic = ' topic="/{name}_{i}" type="std_msgs/Int32" />'
    head = _TIMER
    for i in range(n):
        head += f'<ros_topic_publisher name="p{i}"' + topic.format(name="topic", i=i)
        head += f'<ros_topic_subscriber name="s{i}"' + topic.format(name="tpoic", i=i)
    field = '<field name="data" expr="1" />'
    sends = "".join(f'<ros_topic_publish name="p{i}">{field}</ros_topic_publish>' for i in range(n))
    callbacks = "".join(f'<ros_topic_callback name="s{i}" target="s" />' for i in range(n))
    return _system(_machine(head, callbacks + _on_tick(sends)))


def comments(n: int) -> Files:
    """n comments that suppress findings that do not exist."""
    return _system(_machine(body="<!-- as2fm: ignore[unused-variable] -->" * n))


def threads(n: int) -> Files:
    """n threads of an action."""
    head = '<ros_action_server name="a" action_name="/a" type="example_interfaces/Fibonacci" />'
    thread = f'<ros_action_thread name="a" n_threads="{n}"><state id="w" /></ros_action_thread>'
    return _system(_machine(head, more=thread))


# --------------------------------------------------------------------- systems


def same_machine(n: int) -> Files:
    """One machine that is listed n times."""
    return _system(_machine(_TIMER, _on_tick("")), nodes='<input type="node-ascxml" src="m.ascxml" />' * n)


def machines(n: int) -> Files:
    """n machines, each with a timer and a topic."""
    files = {}
    for i in range(n):
        head = f'{_TIMER}<ros_topic_publisher name="o" topic="/t{i}" type="std_msgs/Int32" />'
        head += f'<ros_topic_subscriber name="i" topic="/t{(i + 1) % n}" type="std_msgs/Int32" />'
        body = _on_tick('<ros_topic_publish name="o"><field name="data" expr="1" /></ros_topic_publish>')
        text = _machine(head, body + '<ros_topic_callback name="i" target="s" />').replace('"M"', f'"M{i}"')
        files[f"m{i}_ascxml"] = text
    nodes = "".join(f'<input type="node-ascxml" src="m{i}.ascxml" />' for i in range(n))
    return _system(nodes=nodes, **files)


def structs(n: int) -> Files:
    """Structs of structs: n members in all, each struct ten of the next."""
    depth = len(str(n))
    types = [
        f'<struct id="S{i}">' + "".join(f'<member id="m{j}" type="S{i + 1}" />' for j in range(10)) + "</struct>"
        for i in range(depth)
    ]
    types.append(f'<struct id="S{depth}"><member id="x" type="int32" /></struct>')
    declared = '<data_declarations><input type="xml" src="t.xml" /></data_declarations>'
    head = '<datamodel><data id="a" type="S0"/></datamodel>'
    return _system(_machine(head), types=declared, t_xml=f"<types>{''.join(types)}</types>")


def messages(n: int) -> Files:
    """Messages of messages: n fields in all, each message ten of the next."""
    depth = len(str(n))
    head = f'<ros_topic_subscriber name="i" topic="/i" type="bomb/M0" />{_TIMER}'
    head += '<ros_topic_publisher name="o" topic="/i" type="bomb/M0" />'
    body = '<ros_topic_callback name="i" target="s" />' + _on_tick('<ros_topic_publish name="o" />')
    files = _system(_machine(head, body))
    for i in range(depth):
        files[f"bomb/msg/M{i}.msg"] = "".join(f"M{i + 1} f{j}\n" for j in range(10))
    return {**files, f"bomb/msg/M{depth}.msg": "int32 x\n", "bomb/package.xml": "<package><name>bomb</name></package>"}


# ----------------------------------------------------------------------- trees

_TREE = '<behavior_tree><input type="bt.cpp-xml" src="tree.xml" /></behavior_tree>'


def _forest(trees: str) -> Files:
    tree = f'<root BTCPP_format="4" main_tree_to_execute="T0">{trees}</root>'
    return _system(nodes="", tree=_TREE, tree_xml=tree)


def nodes(n: int) -> Files:
    """n nodes in a sequence."""
    return _forest(f'<BehaviorTree ID="T0"><Sequence>{"<AlwaysSuccess />" * n}</Sequence></BehaviorTree>')


def subtrees(n: int) -> Files:
    """Subtrees of subtrees: n nodes in all, each tree ten of the next."""
    depth = len(str(n))
    trees = [
        f'<BehaviorTree ID="T{i}"><Sequence>{f"""<SubTree ID="T{i + 1}" />""" * 10}</Sequence></BehaviorTree>'
        for i in range(depth)
    ]
    return _forest("".join(trees) + f'<BehaviorTree ID="T{depth}"><AlwaysSuccess /></BehaviorTree>')


def chained_subtrees(n: int) -> Files:
    """n subtrees, each inside the previous one."""
    trees = [f'<BehaviorTree ID="T{i}"><SubTree ID="T{i + 1}" /></BehaviorTree>' for i in range(n)]
    return _forest("".join(trees) + f'<BehaviorTree ID="T{n}"><AlwaysSuccess /></BehaviorTree>')


def chained_sequences(n: int) -> Files:
    """n subtrees, each in a sequence inside the previous one, all with the outer blackboard."""
    inner = (
        '<BehaviorTree ID="T{}"><Sequence><SubTree ID="T{}" _autoremap="true" x="{{y}}" /></Sequence></BehaviorTree>'
    )
    trees = [inner.format(i, i + 1) for i in range(n)]
    return _forest("".join(trees) + f'<BehaviorTree ID="T{n}"><AlwaysSuccess /></BehaviorTree>')


def unknown_remaps(n: int) -> Files:
    """n uses of a subtree, each with an attribute similar to one of n variables of the subtree."""
    uses = "".join(f'<SubTree ID="T1" port_{i}="1" />' for i in range(n))
    scripts = "".join(f'<Script code="prot_{i} := 1" />' for i in range(n))
    inner = f'<BehaviorTree ID="T1"><Sequence>{scripts}</Sequence></BehaviorTree>'
    return _forest(f'<BehaviorTree ID="T0"><Sequence>{uses}</Sequence></BehaviorTree>{inner}')


def unknown_subtrees(n: int) -> Files:
    """n subtrees that do not exist, each with a name similar to one of n trees."""
    uses = "".join(f'<SubTree ID="Tere_{i}" />' for i in range(n))
    trees = "".join(f'<BehaviorTree ID="Tree_{i}"><AlwaysSuccess /></BehaviorTree>' for i in range(n))
    return _forest(f'<BehaviorTree ID="T0"><Sequence>{uses}</Sequence></BehaviorTree>{trees}')


def blackboard(n: int) -> Files:
    """n variables of the blackboard."""
    sets = "".join(f'<SetBlackboard output_key="v{i}" value="1" />' for i in range(n))
    return _forest(f'<BehaviorTree ID="T0"><Sequence>{sets}</Sequence></BehaviorTree>')


@dataclass(frozen=True)
class Dimension:
    """A dimension in which a system can grow.

    Attributes:
        files: size -> the files of a system, including `main.xml`, by relative path.
        most: the greatest useful size: the text has about 300,000 characters, or its translation would be enormous.
    """

    name: str
    files: Callable[[int], Files]
    most: int

    def texts(self, size: int, folder: str = NOWHERE) -> Files:
        """The texts of the files, by path."""
        return {os.path.normpath(os.path.join(folder, name)): text for name, text in self.files(size).items()}


ENORMOUS = 10**12


def _dimension(files: Callable[[int], Files], most: int) -> Dimension:
    return Dimension(files.__name__.replace("_", "-"), files, most)


DIMENSIONS = (
    _dimension(array_bound, ENORMOUS),
    _dimension(array_dimensions, ENORMOUS),
    _dimension(array_literals, 50_000),
    _dimension(array_comparisons, ENORMOUS),
    _dimension(max_array_size, ENORMOUS),
    _dimension(branches, 5000),
    _dimension(nested_branches, 5000),
    _dimension(transitions, 5000),
    _dimension(targets, 10_000),
    _dimension(states, 5000),
    _dimension(states_and_events, 1_000_000),
    _dimension(variables, 5000),
    _dimension(long_expression, 50_000),
    _dimension(deep_expression, 100_000),
    _dimension(long_string, 300_000),
    _dimension(draws, ENORMOUS),
    _dimension(many_draws, 5000),
    _dimension(unknown_attributes, 20_000),
    _dimension(unknown_elements, 30_000),
    _dimension(findings_in_a_line, 5000),
    _dimension(unknown_variables, 3000),
    _dimension(unknown_states, 3000),
    _dimension(unknown_events, 3000),
    _dimension(unknown_topics, 1000),
    _dimension(comments, 5000),
    _dimension(threads, ENORMOUS),
    _dimension(same_machine, 5000),
    _dimension(machines, 500),
    _dimension(structs, ENORMOUS),
    _dimension(messages, ENORMOUS),
    _dimension(nodes, 15_000),
    _dimension(subtrees, ENORMOUS),
    _dimension(chained_subtrees, 4000),
    _dimension(chained_sequences, 3000),
    _dimension(unknown_remaps, 3000),
    _dimension(unknown_subtrees, 3000),
    _dimension(blackboard, 5000),
)
