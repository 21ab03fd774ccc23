// SPDX-License-Identifier: Apache-2.0
/** The requests and notifications between client and server that are not part of LSP. */

import type { DocumentSymbol, Range, TextDocumentIdentifier, WorkspaceEdit } from "vscode-languageserver-protocol";
import { RequestType } from "vscode-languageserver-protocol";
import type {
    Coverage,
    Direction,
    Picture,
    PictureAction,
    PictureFormat,
    PictureKind,
    Place,
    Theme,
} from "./pictures/contract";
import type { Alignment } from "./stage/alignment";

export type FileKind = "machine" | "system" | "tree" | "structs" | "properties" | "interface" | "model" | "";

/** The kind of a document. `systems` are the URIs of the systems that contain it, its own URI if it is a system. */
export interface About {
    readonly kind: FileKind;
    readonly systems: readonly string[];
    /** Whether the file itself or its system contains a behavior tree. */
    readonly hasTree: boolean;
}

export interface DocumentParams {
    readonly textDocument: TextDocumentIdentifier;
}

export interface PictureParams extends DocumentParams {
    readonly kind: PictureKind;
    /** The ids of the nodes of a tree whose descendants are hidden. */
    readonly collapsed?: readonly string[];
    /** Of a ROS graph, only the nodes that contain all words of this text, and what is connected to them. */
    readonly matching?: string;
    /** Of a ROS graph, only the neighbourhood of the node with this id. */
    readonly around?: string;
}

export interface PictureFileParams extends PictureParams {
    readonly direction: Direction;
    readonly theme: Theme;
    readonly format: PictureFormat;
}

/** The text of an SVG file, and on request the PDF file in base64. */
export interface PictureFile {
    readonly svg: string;
    readonly pdf?: string;
}

/** `range` is the place of a part, null for the whole file; `answers` are those of the previous questions. */
export interface PictureEditParams extends DocumentParams {
    readonly range: Range | null;
    readonly action: PictureAction;
    readonly answers: readonly string[];
}

/** A question to the user: a choice if there are options, otherwise a text, which begins with the proposal. */
export interface PictureQuestion {
    readonly text: string;
    readonly options: readonly { readonly label: string; readonly answer: string; readonly description: string }[];
    readonly proposal: string;
}

/** One of the three; `problem` is the reason why there is no edit, otherwise empty. */
export interface PictureEdit {
    readonly edit: WorkspaceEdit | null;
    readonly question: PictureQuestion | null;
    readonly problem: string;
}

/** A line of the plain form, and the place in the models from which it was generated. */
export interface PlainLine {
    readonly line: number;
    readonly uri: string;
    readonly range: Range;
}

/** A machine as plain SCXML. `problem` is the reason if there is none. */
export interface PlainScxml {
    readonly text: string;
    readonly lines: readonly PlainLine[];
    readonly problem: string;
}

/** A formatted JANI file, and the outline of that text. `problem` is the reason if there is none. */
export interface JaniText {
    readonly text: string;
    readonly symbols: DocumentSymbol[];
    readonly problem: string;
}

export interface Migration {
    readonly edit: WorkspaceEdit | null;
    /** The changes, one line for each file. */
    readonly files: readonly string[];
    readonly problem: string;
}

/** A property as a sentence. `letters` are the names of its events in `text`. */
export interface PropertySentence {
    readonly id: string;
    readonly text: string;
    readonly letters: readonly string[];
    readonly needsTime: boolean;
}

/** The sentences for properties of a system. `events` are the events that it sends, in words. */
export interface PropertySentences {
    readonly sentences: readonly PropertySentence[];
    readonly events: readonly string[];
    readonly hasClock: boolean;
}

/** `sentence` is the id of a sentence, `events` are its events in order, `within` is a number of seconds or empty. */
export interface NewPropertyParams extends DocumentParams {
    readonly sentence: string;
    readonly events: readonly string[];
    readonly within: string;
}

/** `uri` is the property file, `name` the name of the property. */
export interface NewProperty {
    readonly edit: WorkspaceEdit;
    readonly uri: string;
    readonly name: string;
}

/** A parameter of a system. `proposed` are values to try; `limits` states what its declaration allows, or is empty. */
export interface AskedParameter {
    readonly name: string;
    readonly value: string;
    readonly proposed: string;
    readonly limits: string;
}

/** A number in a machine that can become a parameter; `offset` is its place in code points, `comment` may be empty. */
export interface AskedNumber {
    readonly text: string;
    readonly place: string;
    readonly comment: string;
    readonly uri: string;
    readonly offset: number;
}

/** What is asked before an experiment. `numbers` are those that are no parameters yet. */
export interface ExperimentForm {
    readonly parameters: readonly AskedParameter[];
    readonly properties: readonly { readonly name: string; readonly comment: string; readonly expected: string }[];
    readonly numbers: readonly AskedNumber[];
}

export interface NewParameterParams extends DocumentParams {
    readonly offset: number;
}

export const experimentForm = new RequestType<DocumentParams, ExperimentForm, void>("as2fm/experiment");
export const newParameter = new RequestType<NewParameterParams, WorkspaceEdit | null, void>("as2fm/newParameter");
export const propertySentences = new RequestType<DocumentParams, PropertySentences, void>("as2fm/propertySentences");
export const newPropertyEdit = new RequestType<NewPropertyParams, NewProperty, void>("as2fm/newProperty");
export const about = new RequestType<DocumentParams, About, void>("as2fm/about");
export const picture = new RequestType<PictureParams, Picture | null, void>("as2fm/picture");
/** The coverage of the picture that `as2fm/picture` returns for the same parameters; null if nothing was verified. */
export const coverage = new RequestType<PictureParams, Coverage | null, void>("as2fm/coverage");
export const pictureFile = new RequestType<PictureFileParams, PictureFile | null, void>("as2fm/pictureFile");
export const pictureEdit = new RequestType<PictureEditParams, PictureEdit, void>("as2fm/pictureEdit");
export const plainScxml = new RequestType<DocumentParams, PlainScxml, void>("as2fm/plainScxml");
export const janiView = new RequestType<DocumentParams, JaniText, void>("as2fm/janiView");
export const migrate = new RequestType<DocumentParams, Migration, void>("as2fm/migrate");

/** A command of the server; the client opens the file that it returns. */
export const TRANSLATE = "as2fm.translateToJani";

/** A command of the server. Argument: the URI of a system. */
export const SHOW_FIRST_ERROR = "as2fm.showFirstError";

export interface Translated {
    readonly uri: string;
    readonly summary: string;
}

/** A command of the server. Arguments: the URI of a system, names of properties (all if none), and options. */
export const VERIFY = "as2fm.verify";

/** A problem, with its location if it has one. */
export interface Wrong extends Partial<Place> {
    readonly message: string;
}

/** The result of a property: numbers, or an error. Infinite numbers are strings, because JSON has no such numbers. */
export interface Verified {
    readonly property: string;
    /** What the property requires, in a sentence. */
    readonly comment?: string;
    readonly seconds?: number;
    /** Estimate and interval in a few characters. */
    readonly short?: string;
    readonly traces?: number;
    readonly passed?: number;
    readonly failed?: number;
    readonly undecided?: number;
    readonly complete?: boolean;
    readonly expectations?: readonly {
        readonly expected: string;
        readonly met: boolean;
        readonly certain: boolean;
        /** Whether the expectation is met under uniform choices, but not known to be met under all schedulers. */
        readonly under_uniform_choices_only?: boolean;
        /** What the expectation is worth then. */
        readonly uniform?: "accept" | "warn" | "fail";
        /** The number of traces if none of them contradicts an expected 0 or 1. */
        readonly unanimous?: number;
    }[];
    /** Why the number is doubtful because traces got stuck, or is not the minimum or maximum that the property asks for. */
    readonly warning?: string;
    /** The text `no expectation set` if nothing is expected of the result. */
    readonly verdict?: string;
    /** Whether there is a counterexample: a trace that contradicts the expectation. */
    readonly counterexample?: boolean;
    /** Whether there is a trace that supports the property. */
    readonly witness?: boolean;
    readonly error?: Wrong;
}

/** The result about traces in which the system gets stuck: its automata wait for one another. */
export interface Stuckness {
    /** How a trace that gets stuck is reported. */
    readonly level: "warning" | "error";
    /** Which automaton waits for which in the example, as several lines of text. */
    readonly text: string;
    /** Null if no trace got stuck. */
    readonly example: { readonly trace: number } | null;
}

/** The results of properties. `errors` are those of the model; if there are any, there are no results. */
export interface Verification {
    readonly results: readonly Verified[];
    readonly errors: readonly Wrong[];
    readonly stuck?: Stuckness | null;
}

/** The name of the property that every system has: the probability that it gets stuck. */
export const STUCK = "stuck";

/**
 * A property. `stale` and `result` are missing while it has no result. The result is compared with the current
 * expectations.
 */
export interface Property extends Place {
    readonly name: string;
    readonly comment: string;
    readonly stale?: boolean;
    readonly result?: Verified;
    readonly view?: ResultView;
}

/** A known result as it is shown, in the words of the server. */
export interface ResultView {
    readonly words: string;
    readonly mark: "failed" | "uniform" | "passed" | "open" | "undecided" | "doubtful";
    /** The report on the property, line by line. */
    readonly lines: readonly string[];
    /** Which changes make the result stale; "" if none do. */
    readonly since: string;
    readonly counterexample: boolean;
    readonly witness: boolean;
    /** The trace that contradicts the expectation. */
    readonly seed: number | null;
    readonly trace: number | null;
    readonly canSetExpectation: boolean;
    /** Half the width of the interval of an estimate; 0 for an exact value. */
    readonly epsilon: number;
}

export interface VerifiableSystem {
    readonly uri: string;
    readonly properties: readonly Property[];
}

/** A node of a picture. */
export interface Highlight {
    readonly kind: PictureKind;
    readonly uri: string;
    readonly node: string;
}

export interface Step extends Partial<Place> {
    /** The numbers of the first and last step of the turn. */
    readonly step: number;
    readonly lastStep: number;
    readonly time: string;
    /** The name of the automaton in messages. */
    readonly who: string;
    readonly what: string;
    /** The file and the line as shown to the user. */
    readonly place: string;
    /** The effects of the step: changed variables and sent events. */
    readonly details: readonly string[];
    readonly highlights: readonly Highlight[];
}

export interface Counterexample {
    readonly property: string;
    /** What the property requires, why the trace has its verdict, and a summary. */
    readonly heading: string;
    /** The verdict and the length of the trace. */
    readonly summary: string;
    readonly verdict: string;
    readonly seed: number;
    readonly trace: number;
    readonly expected: string;
    readonly stale: boolean;
    readonly steps: readonly Step[];
}

/**
 * The first difference between a trace and the nearest one with the opposite verdict: what an automaton does in each.
 * `there` is null if it does nothing more; `trace` is the number of the other trace, null if it has none. `alignment`
 * says which steps of both belong together.
 */
export interface Parting {
    readonly heading: string;
    readonly here: Step;
    readonly there: Step | null;
    readonly seed: number;
    readonly trace: number | null;
    readonly alignment: Alignment;
}

export interface PropertyParams extends DocumentParams {
    readonly property: string;
}

/** With `witness`, the trace that supports the property is requested. */
export interface CounterexampleParams extends PropertyParams {
    readonly witness?: boolean;
}

/** With `step` and `earlier`: the numbers of steps after which states are compared. */
export interface TraceStateParams extends PropertyParams {
    readonly trace: number;
    readonly step: number;
    readonly earlier: number;
}

/** A value of the state; `before` is null if it is the same as earlier. `hasChanged` includes the rows below. */
export interface StateRow {
    readonly name: string;
    readonly value: string;
    readonly before: string | null;
    readonly hasChanged: boolean;
    readonly rows: readonly StateRow[];
}

/** The expectations that the known result suggests, the current ones, and the name of the file in which one is set. */
export interface Expectations {
    readonly suggestions: readonly string[];
    readonly current: readonly string[];
    readonly file: string;
}

export interface SetExpectationParams extends PropertyParams {
    readonly expected: string;
}

/** An edit of the file at `uri`; `problem` is the reason if there is none. */
export interface ExpectationSet {
    readonly edit: WorkspaceEdit | null;
    readonly uri: string;
    readonly problem: string;
}

/**
 * A mock of leaves of a tree. `milliseconds` is null if a duration has no effect. `origin` states which mock applies if
 * it is not the own one of the leaves.
 */
export interface MockRow {
    readonly pattern: string;
    readonly kind: string;
    readonly probability: number;
    readonly milliseconds: number | null;
    readonly isSet: boolean;
    readonly origin: string;
    readonly reason: string;
    /** The ids of the leaves in the picture of the tree. */
    readonly nodes: readonly string[];
}

/** The mocks of a tree, in the file at `uri`, and the known result in a few words. */
export interface Mocks {
    readonly uri: string;
    readonly exists: boolean;
    readonly rows: readonly MockRow[];
    readonly result: string;
    readonly problem: string;
}

export interface SetMockParams extends DocumentParams {
    readonly pattern: string;
    readonly probability: number;
    readonly milliseconds: number | null;
}

/** An edit of the file with mocks; `problem` is the reason if there is none. */
export interface MockSet {
    readonly edit: WorkspaceEdit | null;
    readonly uri: string;
    readonly problem: string;
}

export const mocks = new RequestType<DocumentParams, Mocks | null, void>("as2fm/mocks");
export const setMock = new RequestType<SetMockParams, MockSet, void>("as2fm/setMock");
export const properties = new RequestType<null, readonly VerifiableSystem[], void>("as2fm/properties");
export const expectations = new RequestType<PropertyParams, Expectations | null, void>("as2fm/expectations");
export const setExpectation = new RequestType<SetExpectationParams, ExpectationSet, void>("as2fm/setExpectation");
export const counterexample = new RequestType<CounterexampleParams, Counterexample | null, void>(
    "as2fm/counterexample",
);
/** Where the trace of `as2fm/counterexample` parts from the nearest one with the opposite verdict; null if nowhere. */
export const parting = new RequestType<CounterexampleParams, Parting | null, void>("as2fm/parting");
export const traceState = new RequestType<TraceStateParams, readonly StateRow[] | null, void>("as2fm/traceState");
