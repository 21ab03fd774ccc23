# SPDX-License-Identifier: Apache-2.0
"""Numbers from distributions in machines: their values have the right probabilities; expanded machines are those that
one would write with targets; findings are at the places in the files."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest
from scipy import stats

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.diagnostics import Severity
from roaml.distributions import calls_distribution
from roaml.distributions.laws import LAWS
from roaml.distributions.outcomes import MAX_CUT
from roaml.ide.completion import complete
from roaml.ide.hover import hover
from roaml.ide.signature_help import signature_help
from roaml.jani.writer import write
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import Span

MAIN = """<roaml>
    <parameter_declarations>
        <parameter name="p" type="float64" value="0.25" min="0" max="1" />
    </parameter_declarations>
    <parameters><max_time value="3" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="dice.ascxml" /></node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>
"""
DICE = """<ascxml name="Dice" version="1.0" initial="start">
    <datamodel>
        <data id="x" type="float64" expr="0.0" />
    </datamodel>
    <ros_topic_publisher name="x" topic="x" type="std_msgs/Float64" />
    <ros_time_rate name="tick" rate_hz="1" />
    <state id="start">
        <ros_rate_callback name="tick" target="end">
            BODY
            <ros_topic_publish name="x"><field name="data" expr="x" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
    <state id="end"><ros_rate_callback name="tick" target="end" /></state>
</ascxml>
"""
PROPERTIES = """<properties>
    <ports>
        <ros_topic topic_name="x" type="std_msgs/Float64" event="publish">
            <state_var id="x" type="float64" field="data" expr="-1000.0" />
        </ros_topic>
    </ports>
    <guarantees>
        <property id="above" pattern="existence"><event>x &gt; LIMIT</event><scope type="globally" /></property>
    </guarantees>
</properties>
"""
DRAW = '<assign location="x" expr="{}" />'


def write_system(folder: Path, body: str, limit: float = 0.0, dice: str = DICE) -> Path:
    (folder / "main.xml").write_text(MAIN, encoding="utf-8")
    (folder / "dice.ascxml").write_text(dice.replace("BODY", body), encoding="utf-8")
    (folder / "properties.xml").write_text(PROPERTIES.replace("LIMIT", str(limit)), encoding="utf-8")
    return folder / "main.xml"


def verified(capsys: pytest.CaptureFixture[str], main: Path, *options: str) -> dict[str, object]:
    capsys.readouterr()
    assert run(["verify", str(main), "--format", "json", *options]) == 0
    found: dict[str, object] = json.loads(capsys.readouterr().out)
    return found


def probability(capsys: pytest.CaptureFixture[str], main: Path, *options: str) -> float:
    (result,) = verified(capsys, main, "--exhaustive", *options)["results"]  # type: ignore[misc]
    value: float = result["exact"]["least"]
    return value


DRAWS = [
    ("normal(2, 0.5, 0.25)", 2.6, stats.norm(2, 0.5).sf(2.625)),
    ("normal(-1, 2, 1)", 0.9, stats.norm(-1, 2).sf(0.5)),
    ("exponential(3, 0.5)", 4.1, stats.expon(scale=3).sf(4.25)),
    ("uniform(1, 3, 0.25)", 2.3, (3 - 2.375) / 2),
    ("uniform_int(1, 6)", 4.5, 1 / 3),
    ("bernoulli(p)", 0.5, 0.25),
    ("bernoulli(1 - p)", 0.5, 0.75),
    ("binomial(10, 0.3)", 4.5, stats.binom(10, 0.3).sf(4)),
    ("geometric(p)", 3.5, 0.75**3),
    ("poisson(2.5)", 4.5, stats.poisson(2.5).sf(4)),
    ("categorical(-1.5, 0.2, 0, 0.3, 7, 0.5)", -1, 0.8),
    ("2 * bernoulli(0.5) + uniform_int(0, 2)", 1.5, 2 / 3),
    ("-normal(2, 0.5, 0.25)", -1.4, stats.norm(2, 0.5).cdf(1.375)),
]
"""A drawn value, a limit, and the probability of a greater value."""


@pytest.mark.parametrize(("draw", "limit", "expected"), DRAWS)
def test_probabilities_are_those_of_the_distributions(
    draw: str, limit: float, expected: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main = write_system(tmp_path, DRAW.format(draw), limit)
    assert probability(capsys, main) == pytest.approx(expected, abs=2 * MAX_CUT)


DATA = "# measured\nseconds,count,note\n1.5,2,a\n4, 1\n\n1.5,1\n2.25,4\n"


@pytest.mark.parametrize(
    ("draw", "limit", "expected"),
    [
        ("histogram('data.csv')", 1.5, 5 / 8),
        ("histogram('data.csv')", 2.2, 5 / 8),
        ("histogram('data.csv')", 2.25, 1 / 8),
        ("histogram('data.csv', 1)", 1.5, 1 / 8 + 4 / 8),
        ("histogram($(var data), 4 * p)", 2, 1 / 8),
    ],
)
def test_values_from_a_file(
    draw: str, limit: float, expected: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "data.csv").write_text(DATA, encoding="utf-8")
    main = write_system(tmp_path, DRAW.format(draw), limit)
    more = '<parameter name="data" type="string" value="data.csv" />'
    main.write_text(MAIN.replace("</parameter_decl", f"{more}</parameter_decl"), encoding="utf-8")
    assert probability(capsys, main) == pytest.approx(expected)


def test_a_changed_file_changes_the_distribution(tmp_path: Path) -> None:
    main, workspace = write_system(tmp_path, DRAW.format("histogram(data)")), Workspace((), Settings())

    def shares() -> list[str]:
        analysis = workspace.snapshot().analysis
        expanded = analysis.expanded(str(main))
        assert expanded is not None
        return re.findall(r'prob="(.*?)"', expanded.expansion.texts[str(tmp_path / "dice.ascxml")].text)

    more = '<parameter name="data" type="string" value="data.csv" />'
    main.write_text(MAIN.replace("</parameter_decl", f"{more}</parameter_decl"), encoding="utf-8")
    (tmp_path / "data.csv").write_text("1\n2\n", encoding="utf-8")
    assert shares() == ["0.5"]
    (tmp_path / "data.csv").write_text("1\n2\n2\n2\n", encoding="utf-8")
    assert shares() == ["0.25"]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("value,count\n", "it contains no values"),
        ("1,2\nfast,3\n", "line 2 is `fast,3`"),
        ("1,-2\n", "line 1 is `1,-2`"),
        ("\n".join(map(str, range(3000))), "3,000 values"),
        (None, "there is no file `data.csv`"),
    ],
)
def test_files_with_invalid_data(content: str | None, reason: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "data.csv").write_text(content, encoding="utf-8")
    main = write_system(tmp_path, DRAW.format("histogram('data.csv')"))
    errors = [d for d in api.check([str(main)]).diagnostics if d.severity is Severity.ERROR]
    assert [error.code for error in errors] == ["invalid-distribution"]
    assert reason in errors[0].message


def test_values_that_are_sent_can_be_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dice = DICE.replace('expr="x" /></ros', 'expr="x + normal(0, 1, 0.5)" /></ros')
    assert probability(capsys, write_system(tmp_path, "", 0.6, dice)) == pytest.approx(
        stats.norm(0, 1).sf(0.75), abs=2 * MAX_CUT
    )
    nested = DICE.replace('expr="x" /></ros', "><expr>uniform_int(0, 3)</expr></field></ros")
    assert probability(capsys, write_system(tmp_path, "", 0.6, nested)) == pytest.approx(0.75)


@pytest.mark.parametrize(("draw", "limit", "expected"), DRAWS)
def test_random_traces_draw_the_same_values(
    draw: str, limit: float, expected: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main = write_system(tmp_path, DRAW.format(draw), limit)
    options = ("--method", "fixed", "--max-traces", "2000", "--confidence", "0.99999", "--jobs", "1")
    (result,) = verified(capsys, main, *options)["results"]  # type: ignore[misc]
    assert result["lower"] <= expected <= result["upper"]


def jani(main: Path) -> str:
    return "".join(write(api.to_jani(api.load(str(main)))))


TARGETS = """<ros_rate_callback name="tick">
            <target id="end" prob="0.25">
                <assign location="x" expr="bernoulli(0.25) + 1" />
            </target>
            <target id="start">
                <assign location="x" expr="2 * categorical(5, 0.75, 6, 0.25)" />
            </target>
        </ros_rate_callback>"""
BY_HAND = """<ros_rate_callback name="tick">
            <target id="end" prob="0.1875"><assign location="x" expr="0 + 1" /></target>
            <target id="end" prob="0.0625"><assign location="x" expr="1 + 1" /></target>
            <target id="start" prob="0.5625"><assign location="x" expr="2 * 5" /></target>
            <target id="start"><assign location="x" expr="2 * 6" /></target>
        </ros_rate_callback>"""
HANDLER = re.compile(r"<ros_rate_callback name=\"tick\" target=\"end\">.*?</ros_rate_callback>", re.DOTALL)


def test_the_targets_are_those_that_one_would_write(tmp_path: Path) -> None:
    publish = '<ros_topic_publish name="x"><field name="data" expr="x" /></ros_topic_publish>'
    texts = []
    for name, handler in (("drawn", TARGETS), ("by_hand", BY_HAND)):
        folder = tmp_path / name
        folder.mkdir()
        sending = handler.replace("</target>", f"{publish}</target>")
        texts.append(jani(write_system(folder, "", dice=HANDLER.sub(sending, DICE))))
    assert texts[0] == texts[1]


def test_the_expanded_files_have_the_same_translation(tmp_path: Path) -> None:
    main = write_system(tmp_path, DRAW.format("normal(p, 1, 0.5) * bernoulli(p)"))
    plain = tmp_path / "plain"
    assert run(["translate", str(main), "--expand", str(plain)]) == 0
    text = (plain / "dice.ascxml").read_text(encoding="utf-8")
    assert not calls_distribution(text)
    assert jani(plain / "main.xml") == jani(main)
    assert not [d for d in api.check([str(plain / "main.xml")]).diagnostics if d.severity is Severity.ERROR]


def test_results_state_the_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    body = DRAW.format("normal(2, p, 0.5) + bernoulli(p) + poisson(1)")
    main = write_system(tmp_path, body)
    assert run(["verify", str(main)]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("drawn: ")]
    normal, poisson = lines  # `bernoulli` has no error
    assert re.search(r"normal\(2, 0\.25, 0\.5\) \(.*dice\.ascxml:9\) with 5 values, each at most 0\.25 from", normal)
    assert re.search(r"poisson\(1\) .* with 10 values; numbers with a probability of at most 1e-07 are cut", poisson)
    rows = verified(capsys, main)["drawn"]
    assert isinstance(rows, list)
    assert [(row["distribution"], row["values"], row["shift"]) for row in rows] == [
        ("normal(2, 0.25, 0.5)", 5, 0.25),
        ("bernoulli(0.25)", 2, 0.0),
        ("poisson(1)", 10, 0.0),
    ]
    assert 0 < rows[0]["cut"] <= MAX_CUT
    assert rows[1]["cut"] == 0


def test_an_experiment_varies_the_arguments(tmp_path: Path) -> None:
    main = write_system(tmp_path, DRAW.format("bernoulli(p) * uniform_int(0, 3)"), 1.5)
    result = api.experiment(str(main), {"p": [0, 0.25, 1]}, ["above"])
    values = [result.point("above", p=p).value for p in (0, 0.25, 1)]
    assert values == pytest.approx([0, 0.125, 0.5])


# ------------------------------------------------------------------------------------------------------------- findings


def findings(main: Path) -> list[tuple[str, str]]:
    """The codes of the warnings and errors in the machine, with their texts."""
    text = (main.parent / "dice.ascxml").read_text(encoding="utf-8")
    found = api.check([str(main)]).diagnostics
    return [
        (d.code, text[d.span.start : d.span.end])
        for d in found
        if d.path.endswith("dice.ascxml") and d.severity in (Severity.ERROR, Severity.WARNING)
    ]


@pytest.mark.parametrize(
    ("draw", "code", "place"),
    [
        ("normal(2, 0.5)", "invalid-distribution", "normal(2, 0.5)"),
        ("normal(2, 0, 1)", "invalid-distribution", "normal(2, 0, 1)"),
        ("normal(2, 1, 0)", "invalid-distribution", "normal(2, 1, 0)"),
        ("normal(2, 1, 0.0001)", "invalid-distribution", "normal(2, 1, 0.0001)"),
        ("bernoulli(x)", "invalid-distribution", "x"),
        ("bernoulli(4 * p + 1)", "invalid-distribution", "bernoulli(4 * p + 1)"),
        ("bernoulli(bernoulli(0.5))", "invalid-distribution", "bernoulli(0.5)"),
        ("uniform_int(0, 99) + uniform_int(0, 99)", "invalid-distribution", "uniform_int(0, 99)"),
        ("histogram(1)", "invalid-distribution", "histogram(1)"),
        ("gaussian(2, 1, 1)", "unknown-function", "gaussian"),
    ],
)
def test_invalid_distributions_are_reported_once(draw: str, code: str, place: str, tmp_path: Path) -> None:
    assert findings(write_system(tmp_path, DRAW.format(draw))) == [(code, place)]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('name="tick" target="end"', 'name="tick" cond="bernoulli(p) == 1" target="end"'),
        ('<state id="end">', f'<state id="end"><onentry>{DRAW.format("bernoulli(p)")}</onentry>'),
        ('expr="0.0"', 'expr="bernoulli(p)"'),
        ("BODY", f'<if cond="bernoulli(p) == 1">{DRAW.format("1.0")}</if>'),
        ("BODY", '<assign location="x[bernoulli(p)]" expr="1.0" />'),
    ],
)
def test_draws_in_other_places_are_errors(old: str, new: str, tmp_path: Path) -> None:
    found = findings(write_system(tmp_path, "", dice=DICE.replace(old, new)))
    assert ("misplaced-random", "bernoulli(p)") in found
    assert not [code for code, text in found if code != "misplaced-random" and "bernoulli" in text]


def test_an_error_in_a_copy_is_reported_once_in_its_place(tmp_path: Path) -> None:
    body = DRAW.format("nothing + normal(2, 0.5, 0.5)") + '<if cond="missing">' + DRAW.format("1.0") + "</if>"
    assert findings(write_system(tmp_path, body)) == [
        ("undeclared-variable", "nothing"),
        ("undeclared-variable", "missing"),
    ]


def test_a_fix_in_a_copy_changes_the_text_of_the_user(tmp_path: Path) -> None:
    main = write_system(
        tmp_path, DRAW.format("uniform_int(1, 3)") + DRAW.format("x + y").replace('location="x"', 'location="xx"')
    )
    check = api.check([str(main)])
    (error,) = (d for d in check.diagnostics if d.code == "undeclared-variable" and d.fixes and "xx" in d.message)
    (edit,) = error.fixes[0].edits
    text = (tmp_path / "dice.ascxml").read_text(encoding="utf-8")
    assert (text[edit.span.start : edit.span.end], edit.new_text) == ("xx", "x")


def test_what_depends_on_a_drawn_value_is_no_finding(tmp_path: Path) -> None:
    """With some of the values, `x + 0` is an assignment of `x` to itself, and the condition always holds."""
    body = DRAW.format("x + uniform_int(0, 2)")
    assert findings(write_system(tmp_path, body)) == []
    always = '<assign location="x" expr="x" />' + DRAW.format("x + uniform_int(1, 2)")
    assert findings(write_system(tmp_path, always)) == [("self-assignment", "x")]


def test_a_branch_after_a_draw_is_executed_for_some_values(tmp_path: Path) -> None:
    """Its condition is constant in each copy of the handler, but not equal in all."""
    branch = '<if cond="x {} 3"><assign location="x" expr="x + 10" /></if>'
    draw = DRAW.format("uniform_int(1, 4)")
    assert findings(write_system(tmp_path, draw + branch.format("=="))) == []
    assert [code for code, _ in findings(write_system(tmp_path, draw + branch.format("&lt; -")))] == [
        "constant-condition"
    ]


def test_origins_are_places_in_the_files(tmp_path: Path) -> None:
    main = write_system(tmp_path, DRAW.format("x + uniform_int(0, 2)"))
    system = api.load(str(main))
    lines = (tmp_path / "dice.ascxml").read_text(encoding="utf-8").splitlines()
    places = api.source_map(system, api.to_jani(system))
    dice = next(automaton for automaton in places["automata"] if automaton["name"] == "Dice")
    found = {lines[edge["line"] - 1].strip().partition(" ")[0] for edge in dice["edges"]}
    assert found <= {"<ros_rate_callback", "<ros_topic_publish", "<assign", "<state"}
    assert "<ros_rate_callback" in found


def test_each_copied_character_leads_to_the_text_of_the_user(tmp_path: Path) -> None:
    main = write_system(tmp_path, DRAW.format("x + p + uniform_int(0, 2) + p"))
    expanded = api.load(str(main)).analysis.expanded(str(main))
    assert expanded is not None
    text = expanded.expansion.texts[str(tmp_path / "dice.ascxml")]
    written = (tmp_path / "dice.ascxml").read_text(encoding="utf-8")
    spans = [Span(offset, offset + 1) for offset in range(len(text.text))]
    kept = [span for span in spans if text.is_written(span)]
    for span in kept:
        origin = text.origin(span)
        assert text.text[span.start] == written[origin.start : origin.end]
        assert text.text[span.start] in text.written(origin) or text.places(span) > 1
    body = written[written.index("<assign") : written.index("</ros_rate")]
    assert len(kept) > len(written) + len(body)
    for match in re.finditer(r"<ros_topic_publish ", text.text):
        assert text.places(Span(*match.span())) == 3
    for match in re.finditer(r"(?<=0\.25 \+ )\d", text.text):
        origin = text.origin(Span(*match.span()))
        assert written[origin.start : origin.end] == "uniform_int(0, 2)"


# --------------------------------------------------------------------------------------------------------------- editor


def test_names_of_distributions_are_recognised() -> None:
    for name in LAWS:
        assert calls_distribution(f"x + {name} (1)")
        assert not calls_distribution(f"x + {name}_({name})")
    assert not calls_distribution("abnormal(1) + Math.floor(1)")


def test_help_for_distributions(tmp_path: Path) -> None:
    main = write_system(tmp_path, DRAW.format("1 + normal(2, 0.5, 0.25)"))
    path, text = str(tmp_path / "dice.ascxml"), (tmp_path / "dice.ascxml").read_text(encoding="utf-8")
    snapshot = api.check([str(main)]).snapshot
    analysis = snapshot.analysis
    at = text.index("normal(")
    shown = hover(analysis, path, at + 2)
    assert shown is not None
    assert "normal(mean, deviation, step)" in shown.text
    found = signature_help(analysis, path, text.index("0.5, 0.25") + 1)
    assert found is not None
    assert (found.label, found.active) == ("normal(mean, deviation, step)", 1)
    completions = complete(snapshot, path, at + 2)
    assert completions is not None
    item = next(item for item in completions.items if item.label == "normal")
    assert item.snippet == "normal(${1:mean}, ${2:deviation}, ${3:step})"


def test_probabilities_of_the_targets_add_up_to_1(tmp_path: Path) -> None:
    main = write_system(tmp_path, DRAW.format("normal(2, 0.5, 0.01)"))
    plain = tmp_path / "plain"
    assert run(["translate", str(main), "--expand", str(plain)]) == 0
    text = (plain / "dice.ascxml").read_text(encoding="utf-8")
    shares = [float(share) for share in re.findall(r'prob="([\d.]+)"', text)]
    assert len(shares) + 1 == text.count("<target ")
    assert 0 < 1 - math.fsum(shares) < 1e-6
