# SPDX-License-Identifier: Apache-2.0
"""Random small systems, as the text of their files."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

import kept_strategies as st

EVENTS = {"alpha": "int", "beta": "bool", "gamma": "list", "delta": None}
"""Events and the kind of their parameter `p`."""

VARIABLES = {"n": "int", "b": "bool", "v": "list", "m": "int"}
_TYPES = {"int": "int32", "bool": "bool", "list": "int32[3]"}
_INITIAL = {"int": ("0", "1", "2"), "bool": ("false", "true"), "list": ("[]", "[1]", "[2, 1]")}
STATES = ("s0", "s1", "s2")


def _attributes(**values: str | None) -> str:
    return "".join(f" {name}={quoteattr(value)}" for name, value in values.items() if value is not None)


@st.composite
def expressions(draw: st.DrawFn, kind: str, event: str | None, depth: int = 2) -> str:
    """Ints stay small, so that there are few states."""
    if depth == 0 or draw(st.booleans()):
        leaves = {
            "int": ["0", "1", "2", "n", "m", "v.length"],
            "bool": ["true", "false", "b"],
            "list": ["v", "[]", "[2]"],
        }
        texts = list(leaves[kind])
        if event is not None and EVENTS[event] == kind:
            texts += ["_event.data.p"] * 3
        return draw(st.sampled_from(texts))
    below = depth - 1
    if kind == "int":
        left, right = (draw(expressions("int", event, below)) for _ in range(2))
        form = draw(st.sampled_from(("({} + {}) % 3", "Math.max({}, {})", "({} * {}) % 3", "Math.abs({} - {})")))
        return form.format(left, right)
    if kind == "bool":
        form = draw(
            st.sampled_from(
                ("{i} < {j}", "{i} == {j}", "!({b})", "({b}) && ({c})", "({b}) || ({c})", "{l} == {k}", "{l} != [1]")
            )
        )
        return form.format(
            i=draw(expressions("int", event, below)),
            j=draw(expressions("int", event, below)),
            b=draw(expressions("bool", event, below)),
            c=draw(expressions("bool", event, below)),
            l=draw(st.sampled_from(("v", "_event.data.p" if event and EVENTS[event] == "list" else "v"))),
            k=draw(st.sampled_from(("v", "[]", "[1]", "[1, 2]"))),
        )
    return draw(expressions("list", event, 0))


@st.composite
def statements(draw: st.DrawFn, event: str | None, known: tuple[str, ...], depth: int = 1) -> str:
    kind = draw(st.sampled_from(("assign", "assign", "append", "compare", "send", "if" if depth else "assign")))
    if kind == "append":
        index = draw(st.sampled_from(("0", "v.length % 3")))
        return f"<assign{_attributes(location=f'v[{index}]', expr=draw(expressions('int', event, 1)))}/>"
    if kind == "compare":
        lists = ("v", "_event.data.p") if event is not None and EVENTS[event] == "list" else ("v",)
        left, operator = draw(st.sampled_from(lists)), draw(st.sampled_from(("==", "!=")))
        right = draw(st.sampled_from((*lists, "[]", "[1]", "[1, 2]", "[2, 1]")))
        return f"<assign{_attributes(location='b', expr=f'{left} {operator} {right}')}/>"
    if kind == "assign":
        variable = draw(st.sampled_from(sorted(VARIABLES)))
        return f"<assign{_attributes(location=variable, expr=draw(expressions(VARIABLES[variable], event)))}/>"
    if kind == "send":
        sent = draw(st.sampled_from(known))
        param = EVENTS[sent]
        if param is None:
            return f"<send{_attributes(event=sent)}/>"
        # Data that an event gets only from itself have no type.
        value = draw(expressions(param, None if sent == event else event))
        return f"<send{_attributes(event=sent)}><param{_attributes(name='p', expr=value)}/></send>"
    body = "".join(draw(st.lists(statements(event, known, depth - 1), min_size=1, max_size=2)))
    otherwise = "".join(draw(st.lists(statements(event, known, depth - 1), max_size=1)))
    cond = draw(expressions("bool", event))
    return f"<if{_attributes(cond=cond)}>{body}<else/>{otherwise}</if>"


@st.kept
def bodies(event: str | None, known: tuple[str, ...], most: int = 2) -> st.SearchStrategy[str]:
    return st.lists(statements(event, known), max_size=most).map("".join)


@st.composite
def transitions(
    draw: st.DrawFn,
    event: str | None,
    cond: str | None,
    states: tuple[str, ...],
    known: tuple[str, ...],
    timer: bool = False,
) -> str:
    tag, trigger = ("ros_rate_callback", {"name": "timer"}) if timer else ("transition", {"event": event})
    seen = None if timer else event
    head = _attributes(**trigger, cond=cond)
    if draw(st.integers(0, 3)) == 0:
        first, second = (draw(st.sampled_from(states)) for _ in range(2))
        one, two = (draw(bodies(seen, known, 1)) for _ in range(2))
        return (
            f'<{tag}{head}><target id="{first}" prob="0.25">{one}</target><target id="{second}">{two}</target></{tag}>'
        )
    return f"<{tag}{head}{_attributes(target=draw(st.sampled_from(states)))}>{draw(bodies(seen, known))}</{tag}>"


@st.composite
def machines(draw: st.DrawFn, name: str, known: tuple[str, ...], timer: bool) -> str:
    states = STATES[: draw(st.integers(1, 3))]
    parts = []
    for state in states:
        content = []
        for tag in ("onentry", "onexit"):
            if draw(st.integers(0, 4)) == 0:
                content.append(f"<{tag}>{draw(bodies(None, known, 1))}</{tag}>")
        if draw(st.integers(0, 2)) == 0:
            cond = draw(st.sampled_from(("n == 1", "b", "v.length < 2", "m > n")))
            content.append(draw(transitions(None, cond, states, known)))
        for event in draw(st.lists(st.sampled_from(known), unique=True, max_size=2)):
            if draw(st.booleans()):
                cond = draw(expressions("bool", event))
                content.append(draw(transitions(event, cond, states, known)))
            if draw(st.booleans()):
                content.append(draw(transitions(event, None, states, known)))
        if timer and draw(st.booleans()):
            content.append(draw(transitions(None, None, states, known, timer=True)))
        parts.append(f'<state id="{state}">{"".join(content)}</state>')
    data = "".join(
        f"<data{_attributes(id=variable, type=_TYPES[kind], expr=draw(st.sampled_from(_INITIAL[kind])))}/>"
        for variable, kind in VARIABLES.items()
    )
    declared = f'<ros_time_rate name="timer" rate_hz="{draw(st.sampled_from((1, 2)))}"/>' if timer else ""
    return (
        f'<ascxml name="{name}" version="1.0" initial="s0"><datamodel>{data}</datamodel>{declared}'
        f"{''.join(parts)}</ascxml>"
    )


def source(events: tuple[str, ...]) -> str:
    """A machine that sends each event once, so that none is never sent."""
    value = {"int": "1", "bool": "true", "list": "[2, 1]"}
    states = []
    for i, event in enumerate(events):
        kind = EVENTS[event]
        param = "" if kind is None else f'<param name="p" expr="{value[kind]}"/>'
        states.append(
            f'<state id="s{i}"><transition target="s{i + 1}"><send event="{event}">{param}</send></transition></state>'
        )
    return f'<ascxml name="source" version="1.0" initial="s0">{"".join(states)}<state id="s{len(events)}"/></ascxml>'


@st.composite
def systems(draw: st.DrawFn) -> dict[str, str]:
    """File name -> text; the system file is `main.xml`."""
    known = tuple(draw(st.lists(st.sampled_from(sorted(EVENTS)), unique=True, min_size=1)))
    files = {"source.ascxml": source(known)}
    for name in ("one", "two", "three")[: draw(st.integers(1, 3))]:
        files[f"{name}.ascxml"] = draw(machines(name, known, draw(st.booleans())))
    inputs = "".join(f'<input type="node-ascxml" src="{file}"/>' for file in files)
    files["properties.jani"] = '{"properties": []}'
    files["main.xml"] = (
        '<roaml><parameters><max_time value="2" unit="s"/><max_array_size value="3"/></parameters>'
        f"<node_models>{inputs}</node_models>"
        '<properties><input type="jani" src="properties.jani"/></properties></roaml>'
    )
    return files
