// SPDX-License-Identifier: Apache-2.0
/** The state of an experiment, as `as2fm-lsp experiment --live` writes it, and the messages between the extension and
 * the page that shows it. */

export interface Plot {
    readonly title: string;
    readonly description: string;
    readonly x: number;
    readonly y: number;
    readonly width: number;
    readonly height: number;
    /** The content of an SVG. The attribute `data-key` of a mark is the key of its point. */
    readonly scene: string;
}

/** `value` is null if there is none, a text if it is infinite. */
export interface Point {
    readonly key: string;
    readonly property: string;
    readonly text: string;
    readonly value: number | string | null;
}

export interface Row {
    readonly setting: Readonly<Record<string, string>>;
    readonly points: readonly (Point | null)[];
}

export interface Live {
    readonly model: string;
    readonly mocks: readonly string[];
    readonly done: number;
    readonly total: number;
    readonly plots: readonly Plot[];
    readonly columns: readonly string[];
    readonly rows: readonly Row[];
    readonly notes: readonly string[];
    readonly answers: readonly string[];
    /** What can be saved; `svg` contains one text for each plot. */
    readonly files: { readonly csv: string; readonly html: string; readonly svg: readonly string[] };
}

/** The texts of the page, in the language of the user. */
export interface ExperimentWords {
    readonly cancel: string;
    readonly again: string;
    readonly save: string;
    readonly run: string;
    /** What a click on a point does, as a sentence. */
    readonly hint: string;
}

export type ToExperiment =
    | { readonly type: "words"; readonly words: ExperimentWords }
    /** `status` is a sentence about the progress, `isRunning` whether it can be cancelled. */
    | { readonly type: "status"; readonly status: string; readonly isRunning: boolean }
    | { readonly type: "live"; readonly live: Live };

export type FromExperiment =
    | { readonly type: "ready" }
    | { readonly type: "cancel" }
    | { readonly type: "again" }
    | { readonly type: "save" }
    /** Debug a run with the setting of a point. */
    | { readonly type: "run"; readonly key: string };
