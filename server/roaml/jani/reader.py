# SPDX-License-Identifier: Apache-2.0
"""Reads JANI models and lists of properties from JSON, and reports the errors in them.

- Reading raises no exception: parts that cannot be read are reported and left out, and the other parts are read. A
  model that is read without errors can be written and checked.
- The findings have the codes `jani-syntax` (the structure is not that of JANI), `jani-name` (a name is undefined or
  declared twice) and `jani-type` (the type of an expression does not fit). Errors in the JSON itself are not reported
  again; `roaml.json_syntax.parse` reports them.
- Every origin is a position in the file.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.durations import ANY, ANY_TIME, REACTION_TIME, ReactionTime, duration, reaction_time
from roaml.jani.expressions import Missing
from roaml.jani.features import SUPPORTED, Feature
from roaml.jani.members import Members, shape
from roaml.jani.model import (
    Assignment,
    Automaton,
    Clock,
    Destination,
    Edge,
    Element,
    Location,
    Metadata,
    Model,
    ModelType,
    Sync,
    System,
    TransientValue,
)
from roaml.jani.names import DeclaredNames
from roaml.jani.notes import SYNTAX, Notes
from roaml.jani.properties import Property
from roaml.jani.read_declarations import DeclarationReader
from roaml.jani.typecheck import check_model
from roaml.json_syntax import JsonObject, JsonString, JsonValue


def read_model(value: JsonValue, path: str = "") -> tuple[Model | None, tuple[Finding, ...]]:
    """The model in `value`, the JSON of the file `path`, and the findings. The model is `None` if `value` is not an
    object."""
    notes = Notes()
    model = _ModelReader(path, notes).model(value)
    if model is None:
        return None, notes.findings
    findings = (*notes.findings, *check_model(model))
    return model, tuple(sorted(findings, key=lambda finding: finding.span))


def read_properties(value: JsonValue, path: str = "") -> tuple[tuple[Property, ...], tuple[Finding, ...]]:
    """The properties in `value`, and the findings. `value` is the JSON of a property file or of a model: an object with
    a list `properties`.

    Other members of the object are ignored. Names and types are not checked, because the variables are declared in
    another file; `typecheck.check_property` checks them.
    """
    notes = Notes()
    reader = _ModelReader(path, notes)
    if not isinstance(value, JsonObject):
        reader.wrong_kind(value, "a property file must be an object `{ }`")
        return (), notes.findings
    only_properties = JsonObject(value.start, value.end, tuple(m for m in value.members if m.key == "properties"))
    return reader.properties(Members(only_properties, _PROPERTY_FILE, reader)), notes.findings


_PROPERTY_FILE = shape("a property file", "properties")
_MODEL = shape(
    "a model",
    "jani-version type automata system",
    "name metadata features actions constants variables datatypes functions restrict-initial properties",
)
_METADATA = shape("metadata", "", "version author description doi url clock reaction-time", is_open=True)
_CLOCK = shape("a clock", "automaton actions step", is_open=True)
_AUTOMATON = shape(
    "an automaton", "name locations initial-locations edges", "variables functions restrict-initial comment"
)
_LOCATION = shape("a location", "name", "time-progress transient-values comment")
_TRANSIENT_VALUE = shape("a transient value", "ref value", "comment")
_EDGE = shape("an edge", "location destinations", "action rate guard comment")
_DESTINATION = shape("a destination", "location", "probability assignments comment")
_ASSIGNMENT = shape("an assignment", "ref value", "index comment")
_SYSTEM = shape("a system", "elements", "syncs comment")
_ELEMENT = shape("an element", "automaton", "input-enable comment")
_SYNC = shape("a synchronisation", "synchronise", "result comment")
_PROPERTY = shape("a property", "name expression", "comment")


class _ModelReader(DeclarationReader):
    """Reads one file. Declarations are read before the parts that refer to them, so that names can be resolved at
    once."""

    def __init__(self, path: str, notes: Notes) -> None:
        super().__init__(path, notes)
        self.automata = DeclaredNames("automaton", notes)

    def model(self, value: JsonValue) -> Model | None:
        members = self.members(value, _MODEL)
        if members is None:
            return None
        self.version(members)
        metadata = members.values.get("metadata")
        return Model(
            name=members.comment("name") or "",
            type=self.choice(members.values.get("type"), "model type", ModelType) or ModelType.LTS,
            features=self.features(members),
            metadata=None if metadata is None else self.metadata(metadata),
            actions=self.actions_of(members),
            constants=self.constants(members),
            variables=self.variables_of(members, self.variables),
            datatypes=self.datatypes(members),
            functions=self.functions_of(members, self.functions),
            restrict_initial=self.clause(members, "restrict-initial"),
            automata=self.automata_of(members),
            system=self.system(members),
            properties=self.properties(members),
            origin=members.origin,
        )

    # ---------------------------------------------------------------- header

    def version(self, members: Members) -> None:
        version = members.integer("jani-version")
        if version is not None and version != 1:
            self.notes.syntax(
                members.values["jani-version"].span, "only version 1 of JANI is supported", Severity.WARNING
            )

    def features(self, members: Members) -> tuple[str, ...]:
        features: list[str] = []
        known = {feature.value: feature for feature in Feature}
        for item in members.items("features"):
            if not isinstance(item, JsonString):
                self.wrong_kind(item, "a feature must be a string")
                continue
            name = item.value
            if name in known and known[name] not in SUPPORTED:
                self.notes.syntax(item.span, f"the feature `{name}` of JANI is not supported", Severity.WARNING)
            elif name not in known and not name.startswith("x-"):
                self.notes.unknown("feature", name, item.content_span, known, code=SYNTAX, severity=Severity.WARNING)
            if name not in features:
                features.append(name)
        return tuple(features)

    def metadata(self, value: JsonValue) -> Metadata | None:
        members = self.members(value, _METADATA)
        if members is None:
            return None
        return Metadata(
            members.comment("version"),
            members.comment("author"),
            members.comment("description"),
            members.comment("doi"),
            members.comment("url"),
            self.clock(members),
            self.reaction_time(members),
            origin=members.origin,
        )

    def clock(self, metadata: Members) -> Clock | None:
        members = self.members(metadata.values.get("clock"), _CLOCK)
        if members is None:
            return None
        step = duration(members.text("step") or "")
        actions = tuple(item.value for item in members.items("actions") if isinstance(item, JsonString))
        if step is None:
            self.notes.syntax(members.origin.span, "the step of the clock must be a duration such as `500 ms`")
            return None
        return Clock(members.text("automaton") or "", actions, step, origin=members.origin)

    def reaction_time(self, metadata: Members) -> ReactionTime:
        value = metadata.values.get("reaction-time")
        text = metadata.text("reaction-time") if value is not None else ANY
        time = reaction_time(text or ANY)
        if time is None:
            assert value is not None
            self.notes.syntax(value.span, REACTION_TIME)
        return time or ANY_TIME

    # ---------------------------------------------------------------- automata

    def automata_of(self, model: Members) -> tuple[Automaton, ...]:
        return tuple(self.automaton(members) for members in self.objects(model, "automata", _AUTOMATON))

    def automaton(self, members: Members) -> Automaton:
        locations = DeclaredNames("location", self.notes)
        return Automaton(
            self.declare(members, self.automata) or "",
            variables=self.variables_of(members, DeclaredNames("variable", self.notes, self.variables)),
            functions=self.functions_of(members, DeclaredNames("function", self.notes, self.functions)),
            locations=self.locations(members, locations),
            initial_locations=self.uses(members, "initial-locations", locations),
            restrict_initial=self.clause(members, "restrict-initial"),
            edges=tuple(self.edges(members, locations)),
            comment=members.comment(),
            origin=members.origin,
        )

    def locations(self, automaton: Members, names: DeclaredNames) -> tuple[Location, ...]:
        locations: list[Location] = []
        for members in self.objects(automaton, "locations", _LOCATION):
            if name := self.declare(members, names):
                location = Location(
                    name,
                    self.clause(members, "time-progress"),
                    self.transient_values(members),
                    comment=members.comment(),
                    origin=members.origin,
                )
                locations.append(location)
        return tuple(locations)

    def transient_values(self, location: Members) -> tuple[TransientValue, ...]:
        values: list[TransientValue] = []
        for members in self.objects(location, "transient-values", _TRANSIENT_VALUE):
            target = self.target(members)
            value = self.required(members, "value")
            values.append(TransientValue(target, value, comment=members.comment(), origin=members.origin))
        return tuple(values)

    def edges(self, automaton: Members, locations: DeclaredNames) -> Iterator[Edge]:
        for members in self.objects(automaton, "edges", _EDGE):
            yield Edge(
                self.use(members, "location", locations) or "",
                tuple(self.destinations(members, locations)),
                self.use(members, "action", self.actions),
                self.clause(members, "guard"),
                self.clause(members, "rate"),
                comment=members.comment(),
                origin=members.origin,
            )

    def destinations(self, edge: Members, locations: DeclaredNames) -> Iterator[Destination]:
        for members in self.objects(edge, "destinations", _DESTINATION):
            yield Destination(
                self.use(members, "location", locations) or "",
                self.clause(members, "probability"),
                tuple(self.assignments(members)),
                comment=members.comment(),
                origin=members.origin,
            )

    def assignments(self, destination: Members) -> Iterator[Assignment]:
        for members in self.objects(destination, "assignments", _ASSIGNMENT):
            yield Assignment(
                self.target(members),
                self.required(members, "value"),
                members.integer("index") or 0,
                comment=members.comment(),
                origin=members.origin,
            )

    # ---------------------------------------------------------------- system and properties

    def system(self, model: Members) -> System:
        value = model.values.get("system")
        members = None if value is None else self.members(value, _SYSTEM)
        if members is None:
            return System(())
        elements = tuple(self.elements(members))
        syncs = tuple(self.syncs(members, len(members.items("elements"))))
        return System(elements, syncs, comment=members.comment(), origin=members.origin)

    def elements(self, system: Members) -> Iterator[Element]:
        for members in self.objects(system, "elements", _ELEMENT):
            yield Element(
                self.use(members, "automaton", self.automata) or "",
                self.uses(members, "input-enable", self.actions),
                comment=members.comment(),
                origin=members.origin,
            )

    def syncs(self, system: Members, size: int) -> Iterator[Sync]:
        for members in self.objects(system, "syncs", _SYNC):
            participants: list[tuple[int, str]] = []
            if vector := members.array("synchronise"):
                for index, item in vector.items_but_nulls:
                    if isinstance(item, JsonString):
                        self.actions.use(item)
                        participants.append((index, item.value))
                    else:
                        self.wrong_kind(item, "an action must be a string or null")
                if vector.length != size:
                    message = (
                        f"the vector must have an entry for each element of the system: {size}, not {vector.length}"
                    )
                    self.notes.syntax(vector.span, message)
            result = self.use(members, "result", self.actions)
            yield Sync(tuple(participants), result, comment=members.comment(), origin=members.origin)

    def properties(self, owner: Members) -> tuple[Property, ...]:
        """The properties of a model or a property file."""
        properties: list[Property] = []
        names = DeclaredNames("property", self.notes)
        for members in self.objects(owner, "properties", _PROPERTY):
            value = members.values.get("expression")
            formula = Missing(origin=members.origin) if value is None else self.formula(value)
            name = self.declare(members, names) or ""
            properties.append(Property(name, formula, comment=members.comment(), origin=members.origin))
        return tuple(properties)
