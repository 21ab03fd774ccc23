// SPDX-License-Identifier: Apache-2.0
/** What client and server say to each other beyond the language server protocol. */

import type { DocumentSymbol, Range, TextDocumentIdentifier, WorkspaceEdit } from "vscode-languageserver-protocol";
import { RequestType } from "vscode-languageserver-protocol";
import type { Picture, PictureKind, Place } from "./pictures/contract";

export type FileKind = "machine" | "system" | "tree" | "structs" | "properties" | "interface" | "model" | "";

/** What a document is. `systems` are the URIs of the systems that it belongs to, itself if it is one. */
export interface About {
    readonly kind: FileKind;
    readonly systems: readonly string[];
    /** Whether there is a behavior tree: in the file itself or in its system. */
    readonly hasTree: boolean;
}

export interface DocumentParams {
    readonly textDocument: TextDocumentIdentifier;
}

export interface PictureParams extends DocumentParams {
    readonly kind: PictureKind;
}

/** A line of the plain form and the place in the models that it exists for. */
export interface PlainLine {
    readonly line: number;
    readonly uri: string;
    readonly range: Range;
}

/** A machine as plain SCXML. `problem` says why there is none. */
export interface PlainScxml {
    readonly text: string;
    readonly lines: readonly PlainLine[];
    readonly problem: string;
}

/** A JANI file laid out for reading, and the outline of that text. `problem` says why there is none. */
export interface JaniText {
    readonly text: string;
    readonly symbols: DocumentSymbol[];
    readonly problem: string;
}

export interface Migration {
    readonly edit: WorkspaceEdit | null;
    /** What changes, one line for each file. */
    readonly files: readonly string[];
    readonly problem: string;
}

export const about = new RequestType<DocumentParams, About, void>("as2fm/about");
export const picture = new RequestType<PictureParams, Picture | null, void>("as2fm/picture");
export const plainScxml = new RequestType<DocumentParams, PlainScxml, void>("as2fm/plainScxml");
export const janiView = new RequestType<DocumentParams, JaniText, void>("as2fm/janiView");
export const migrate = new RequestType<DocumentParams, Migration, void>("as2fm/migrate");

/** The server's own command; the client opens what it answers. */
export const TRANSLATE = "as2fm.translateToJani";

/** The server's own command: the URI of a system. */
export const SHOW_FIRST_ERROR = "as2fm.showFirstError";

export interface Translated {
    readonly uri: string;
    readonly summary: string;
}

/** The server's own command: the URI of a system, names of properties (all if none), and options. */
export const VERIFY = "as2fm.verify";

/** Something that is wrong, with its place if it has one. */
export interface Wrong extends Partial<Place> {
    readonly message: string;
}

/** What came of a property: numbers, or an error. JSON has no infinite numbers; those are words. */
export interface Verified {
    readonly property: string;
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
        /** Whether uniform choices meet it, and it is not known whether all schedulers do. */
        readonly under_uniform_choices_only?: boolean;
    }[];
    /** What the number is not, if the property asks for a minimum or maximum. */
    readonly warning?: string;
    /** Whether there is a trace that speaks against what is expected. */
    readonly counterexample?: boolean;
    readonly error?: Wrong;
}

/** What is known of a system getting stuck, that is of traces in which everybody waits for somebody else. */
export interface Stuckness {
    /** What it is that a trace gets stuck. */
    readonly level: "warning" | "error";
    /** Who waits for whom in the example, in some lines. */
    readonly text: string;
    /** Null if no trace got stuck. */
    readonly example: { readonly trace: number } | null;
}

/** `errors` are those of the model; then there are no results. */
export interface Verification {
    readonly results: readonly Verified[];
    readonly errors: readonly Wrong[];
    readonly stuck?: Stuckness | null;
}

/** The property that every system has: that it gets stuck. */
export const STUCK = "stuck";

/** A property; `stale` is missing while nothing is known of it. */
export interface Property extends Place {
    readonly name: string;
    readonly comment: string;
    readonly stale?: boolean;
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
    readonly step: number;
    readonly time: string;
    /** The automaton, for people. */
    readonly who: string;
    readonly what: string;
    /** File and line, for people. */
    readonly place: string;
    /** What has come of it: what has changed, what was sent. */
    readonly details: readonly string[];
    readonly highlights: readonly Highlight[];
}

export interface Counterexample {
    readonly property: string;
    readonly heading: string;
    readonly verdict: string;
    readonly trace: number;
    readonly expected: string;
    readonly stale: boolean;
    readonly steps: readonly Step[];
}

export interface CounterexampleParams extends DocumentParams {
    readonly property: string;
}

export const properties = new RequestType<null, readonly VerifiableSystem[], void>("as2fm/properties");
export const counterexample = new RequestType<CounterexampleParams, Counterexample | null, void>(
    "as2fm/counterexample",
);
