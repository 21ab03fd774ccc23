# SPDX-License-Identifier: Apache-2.0
"""The public interface for other programs; see `docs/library.md`.

    from roaml import api

    result = api.check(["main.xml"], ros_paths=["interfaces"])
    for diagnostic in result.diagnostics:
        print(diagnostic.path, diagnostic.message)

    system = api.load("main.xml")
    text = "".join(api.write_jani(api.to_jani(system)))
    for result in api.verify(system, jobs=2, expectations=["alarm >= 0.95"]):
        print(result.name, result.answer.value, result.answer.bounds, result.is_met)

Errors in the user's files are neither printed nor raised. A path that does not exist raises a `PathError`. Each
name is imported when it is used, so that a program loads only what it needs.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from roaml.api.checking import CheckResult, check, fix
    from roaml.api.comparing import (
        ComparedPicture,
        ComparedVersion,
        StructuralChanges,
        compare_structure,
        compare_values,
    )
    from roaml.api.drawing import DrawingError, DrawnPicture, draw
    from roaml.api.experimenting import experiment, find_enough, grid_of, over_intervals
    from roaml.api.jani_files import JaniError, PathError, read_jani
    from roaml.api.migrating import SharedFileError, migrate
    from roaml.api.parametric_mocks import MockTexts
    from roaml.api.simulating import session
    from roaml.api.systems import (
        LoadedSystem,
        ModelError,
        ParameterError,
        load,
        loaded,
        source_map,
        to_jani,
        to_plain,
        to_scxml,
    )
    from roaml.api.trees import propose_mocks
    from roaml.api.verifying import ConstantError, as_target, checker, target, verifier, verify
    from roaml.comparison import Comparison, UniformPolicy
    from roaml.diagnostics import Diagnostic, Severity
    from roaml.expansion.draws import DrawnNumber
    from roaml.experiments.changes import ValueChange, ValueVerdict
    from roaml.experiments.enough import Enough, Met, Trend
    from roaml.experiments.grid import ExperimentOptions, Grid
    from roaml.experiments.intervals import IntervalError
    from roaml.experiments.points import ExperimentPoint, PointKind, Schedulers
    from roaml.experiments.results import ExperimentResult
    from roaml.experiments.sweeps import Sweep, SweepError
    from roaml.explicit.path import EndlessTrace
    from roaml.explicit.space import ExplorationProgress, ExplorationWatch, StateLimits
    from roaml.figures.layout import LayoutDirection
    from roaml.ide.diagrams import DiagramKind
    from roaml.jani.model import Model
    from roaml.jani.node import Origin
    from roaml.jani.properties import Property
    from roaml.jani.selection import PropertyError
    from roaml.jani.writer import write as write_jani
    from roaml.mocks.mock import Mock, MockError, read_mocks
    from roaml.mocks.proposal import LeafKind, MockableLeaf, proposed_text
    from roaml.model.parameters import NO_OVERRIDES, Overrides
    from roaml.project.analysis import Analysis
    from roaml.project.migrate import Migration
    from roaml.project.settings import Settings
    from roaml.project.source_map import SourceMap
    from roaml.project.workspace import Snapshot
    from roaml.scxml.model import Network
    from roaml.scxml.observed import ObservedProperty
    from roaml.scxml.writer import write as write_scxml
    from roaml.simulation.choices import Choice, Outcome
    from roaml.simulation.run import Decision, RunError
    from roaml.simulation.session import SavedSession, Session
    from roaml.simulation.state import EventState, MachineState, NodeState, NodeStatus, SystemState
    from roaml.simulation.table import Cell, columns
    from roaml.smc.choices import Choices, Extreme, ExtremeMethod
    from roaml.smc.end import End
    from roaml.smc.fault import FaultError
    from roaml.smc.goal import CompiledProperty, InitialFold, Question, Threshold
    from roaml.smc.lss import Search, Side
    from roaml.smc.model import ModelChecker
    from roaml.smc.pool import Pool, Pulse, WorkersLostError
    from roaml.smc.record import Recorder, Recording, TraceStep, TraceVerdict
    from roaml.smc.run import Answer, EstimationMethod, Options, Watch
    from roaml.smc.statistics import Bounds
    from roaml.smc.story import Story
    from roaml.smc.tally import Tally
    from roaml.text import Location, SourceFile, Span
    from roaml.verification.counterexample import Counterexample, counterexample
    from roaml.verification.expectations import Expectation, RangeError, Verdict
    from roaml.verification.explorations import Explorations
    from roaml.verification.growth import GrowingVariable
    from roaml.verification.nearest import Nearest, nearest
    from roaml.verification.refusal import Refusal
    from roaml.verification.results import (
        Computed,
        CutShort,
        Estimated,
        Exact,
        Proof,
        Refused,
        Result,
        RewardQuantile,
        Sampled,
        SampledResult,
        ShortestTrace,
        Traces,
        Undecided,
        UnderAssumption,
    )
    from roaml.verification.searches import Searches
    from roaml.verification.small import Budget
    from roaml.verification.stuck import Stuck, StuckLevel, StuckResult
    from roaml.verification.target import LineColumn, VerificationTarget
    from roaml.verification.verifier import NoThresholdError, Verifier
    from roaml.views.parting import Parting, parting
    from roaml.views.story import StoryLine
    from roaml.views.waiting import Wait
else:
    _IMPORTED_ON_USE = {
        "roaml.comparison": ("Comparison", "UniformPolicy"),
        "roaml.api.checking": ("CheckResult", "check", "fix"),
        "roaml.api.comparing": (
            "ComparedPicture",
            "StructuralChanges",
            "ComparedVersion",
            "compare_structure",
            "compare_values",
        ),
        "roaml.api.drawing": ("DrawingError", "DrawnPicture", "draw"),
        "roaml.api.experimenting": ("experiment", "find_enough", "grid_of", "over_intervals"),
        "roaml.api.jani_files": ("JaniError", "PathError", "read_jani"),
        "roaml.api.migrating": ("SharedFileError", "migrate"),
        "roaml.api.parametric_mocks": ("MockTexts",),
        "roaml.api.simulating": ("session",),
        "roaml.api.systems": (
            "LoadedSystem",
            "ModelError",
            "ParameterError",
            "load",
            "loaded",
            "source_map",
            "to_jani",
            "to_plain",
            "to_scxml",
        ),
        "roaml.api.trees": ("propose_mocks",),
        "roaml.api.verifying": ("ConstantError", "as_target", "checker", "target", "verifier", "verify"),
        "roaml.diagnostics": ("Diagnostic", "Severity"),
        "roaml.experiments.changes": ("ValueChange", "ValueVerdict"),
        "roaml.experiments.enough": ("Enough", "Met", "Trend"),
        "roaml.experiments.grid": ("ExperimentOptions", "Grid"),
        "roaml.experiments.intervals": ("IntervalError",),
        "roaml.experiments.points": ("ExperimentPoint", "PointKind", "Schedulers"),
        "roaml.experiments.results": ("ExperimentResult",),
        "roaml.experiments.sweeps": ("Sweep", "SweepError"),
        "roaml.expansion.draws": ("DrawnNumber",),
        "roaml.figures.layout": ("LayoutDirection",),
        "roaml.ide.diagrams": ("DiagramKind",),
        "roaml.jani.model": ("Model",),
        "roaml.jani.node": ("Origin",),
        "roaml.jani.properties": ("Property",),
        "roaml.jani.selection": ("PropertyError",),
        "roaml.mocks.mock": ("Mock", "MockError", "read_mocks"),
        "roaml.mocks.proposal": ("LeafKind", "MockableLeaf", "proposed_text"),
        "roaml.model.parameters": ("NO_OVERRIDES", "Overrides"),
        "roaml.project.analysis": ("Analysis",),
        "roaml.project.migrate": ("Migration",),
        "roaml.project.settings": ("Settings",),
        "roaml.project.source_map": ("SourceMap",),
        "roaml.project.workspace": ("Snapshot",),
        "roaml.scxml.model": ("Network",),
        "roaml.scxml.observed": ("ObservedProperty",),
        "roaml.text": ("Location", "SourceFile", "Span"),
        "roaml.simulation.choices": ("Choice", "Outcome"),
        "roaml.simulation.run": ("Decision", "RunError"),
        "roaml.simulation.session": ("SavedSession", "Session"),
        "roaml.simulation.state": ("EventState", "MachineState", "NodeState", "NodeStatus", "SystemState"),
        "roaml.simulation.table": ("Cell", "columns"),
        "roaml.smc.choices": ("Choices", "Extreme", "ExtremeMethod"),
        "roaml.smc.end": ("End",),
        "roaml.smc.fault": ("FaultError",),
        "roaml.smc.goal": ("CompiledProperty", "InitialFold", "Question", "Threshold"),
        "roaml.smc.lss": ("Search", "Side"),
        "roaml.smc.model": ("ModelChecker",),
        "roaml.smc.pool": ("Pool", "Pulse", "WorkersLostError"),
        "roaml.smc.record": ("Recorder", "Recording", "TraceStep", "TraceVerdict"),
        "roaml.verification.growth": ("GrowingVariable",),
        "roaml.explicit.path": ("EndlessTrace",),
        "roaml.explicit.space": ("ExplorationProgress", "ExplorationWatch", "StateLimits"),
        "roaml.smc.run": ("Answer", "EstimationMethod", "Options", "Tally", "Watch"),
        "roaml.smc.statistics": ("Bounds",),
        "roaml.smc.story": ("Story",),
        "roaml.verification.counterexample": ("Counterexample", "counterexample"),
        "roaml.verification.expectations": ("Expectation", "RangeError", "Verdict"),
        "roaml.verification.nearest": ("Nearest", "nearest"),
        "roaml.verification.explorations": ("Explorations",),
        "roaml.verification.refusal": ("Refusal",),
        "roaml.verification.results": (
            "Computed",
            "UnderAssumption",
            "Estimated",
            "Exact",
            "CutShort",
            "Proof",
            "Refused",
            "Result",
            "RewardQuantile",
            "Sampled",
            "SampledResult",
            "ShortestTrace",
            "Traces",
            "Undecided",
        ),
        "roaml.verification.searches": ("Searches",),
        "roaml.verification.small": ("Budget",),
        "roaml.verification.stuck": ("StuckResult", "Stuck", "StuckLevel"),
        "roaml.verification.target": ("LineColumn", "VerificationTarget"),
        "roaml.verification.verifier": ("NoThresholdError", "Verifier"),
        "roaml.views.parting": ("Parting", "parting"),
        "roaml.views.story": ("StoryLine",),
        "roaml.views.waiting": ("Wait",),
    }
    _ORIGINS = {name: (module, name) for module, names in _IMPORTED_ON_USE.items() for name in names}
    _ORIGINS["write_jani"] = ("roaml.jani.writer", "write")
    _ORIGINS["write_scxml"] = ("roaml.scxml.writer", "write")

    def __getattr__(name: str) -> object:
        if name not in _ORIGINS:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module, attribute = _ORIGINS[name]
        return getattr(importlib.import_module(module), attribute)


__all__ = [
    "NO_OVERRIDES",
    "Analysis",
    "Answer",
    "Bounds",
    "Budget",
    "Cell",
    "CheckResult",
    "Choice",
    "Choices",
    "ComparedPicture",
    "ComparedVersion",
    "Comparison",
    "CompiledProperty",
    "Computed",
    "ConstantError",
    "Counterexample",
    "CutShort",
    "Decision",
    "Diagnostic",
    "DiagramKind",
    "DrawingError",
    "DrawnNumber",
    "DrawnPicture",
    "End",
    "EndlessTrace",
    "Enough",
    "Estimated",
    "EstimationMethod",
    "EventState",
    "Exact",
    "Expectation",
    "ExperimentOptions",
    "ExperimentPoint",
    "ExperimentResult",
    "ExplorationProgress",
    "ExplorationWatch",
    "Explorations",
    "Extreme",
    "ExtremeMethod",
    "FaultError",
    "Grid",
    "GrowingVariable",
    "InitialFold",
    "IntervalError",
    "JaniError",
    "LayoutDirection",
    "LeafKind",
    "LineColumn",
    "LoadedSystem",
    "Location",
    "MachineState",
    "Met",
    "Migration",
    "Mock",
    "MockError",
    "MockTexts",
    "MockableLeaf",
    "Model",
    "ModelChecker",
    "ModelError",
    "Nearest",
    "Network",
    "NoThresholdError",
    "NodeState",
    "NodeStatus",
    "ObservedProperty",
    "Options",
    "Origin",
    "Outcome",
    "Overrides",
    "ParameterError",
    "Parting",
    "PathError",
    "PointKind",
    "Pool",
    "Proof",
    "Property",
    "PropertyError",
    "Pulse",
    "Question",
    "RangeError",
    "Recorder",
    "Recording",
    "Refusal",
    "Refused",
    "Result",
    "RewardQuantile",
    "RunError",
    "Sampled",
    "SampledResult",
    "SavedSession",
    "Schedulers",
    "Search",
    "Searches",
    "Session",
    "Settings",
    "Severity",
    "SharedFileError",
    "ShortestTrace",
    "Side",
    "Snapshot",
    "SourceFile",
    "SourceMap",
    "Span",
    "StateLimits",
    "Story",
    "StoryLine",
    "StructuralChanges",
    "Stuck",
    "StuckLevel",
    "StuckResult",
    "Sweep",
    "SweepError",
    "SystemState",
    "Tally",
    "Threshold",
    "TraceStep",
    "TraceVerdict",
    "Traces",
    "Trend",
    "Undecided",
    "UnderAssumption",
    "UniformPolicy",
    "ValueChange",
    "ValueVerdict",
    "Verdict",
    "VerificationTarget",
    "Verifier",
    "Wait",
    "Watch",
    "WorkersLostError",
    "as_target",
    "check",
    "checker",
    "columns",
    "compare_structure",
    "compare_values",
    "counterexample",
    "draw",
    "experiment",
    "find_enough",
    "fix",
    "grid_of",
    "load",
    "loaded",
    "migrate",
    "nearest",
    "over_intervals",
    "parting",
    "propose_mocks",
    "proposed_text",
    "read_jani",
    "read_mocks",
    "session",
    "source_map",
    "target",
    "to_jani",
    "to_plain",
    "to_scxml",
    "verifier",
    "verify",
    "write_jani",
    "write_scxml",
]
