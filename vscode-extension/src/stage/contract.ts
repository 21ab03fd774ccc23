// SPDX-License-Identifier: Apache-2.0
/** The messages between the extension and the stage, which shows all pictures of a run and its timeline in one page. */

import type { Activity, FromView, PictureKind, Place, ToView } from "../pictures/contract";
import type { Axis, FromTimeline, ToTimeline } from "../timeline/contract";
import type { Alignment, SideName } from "./alignment";

/** The pictures on the stage, in their order. */
export const PICTURES = ["system", "tree", "ros"] as const satisfies readonly PictureKind[];
export type PicturePane = (typeof PICTURES)[number];
export type Pane = PicturePane | "timeline" | "properties";

export type Verdict = "passed" | "failed" | "undecided";

/** A state of a run that is played. */
export interface Moment {
    readonly step: number;
    /** On the axis that was asked for, in s or steps. */
    readonly position: number;
    /** In s; null if the model has no clock. */
    readonly time: number | null;
    readonly isEnd: boolean;
    /** Why a breakpoint stops the run here, "" for one on a line; null if none does. */
    readonly stop: string | null;
    readonly activity: Readonly<Record<PicturePane, Activity>>;
    readonly verdicts: Readonly<Record<string, Verdict>>;
}

/** The states at `from`, `from + by`, …, at most `count`; with `after`, those after this step. */
export interface MomentsRequest {
    readonly axis: Axis;
    readonly from: number;
    readonly by: number;
    readonly count: number;
    readonly after?: number;
}

/** A property of the run; `text` is what it requires, in a sentence, if it is written. */
export interface StageProperty {
    readonly name: string;
    readonly text: string;
    readonly verdict: Verdict;
    readonly place: Place | null;
}

/** The state in which the run has stopped. */
export interface StageState {
    readonly step: number;
    readonly time: number | null;
    /** What happens next, or why nothing does. */
    readonly next: string;
    readonly isEnd: boolean;
    readonly properties: readonly StageProperty[];
}

/** How the run is moved by the buttons of the stage, in their order. */
export const MOVES = ["toStart", "reverse", "stepBack", "stepForward", "continue"] as const;
export type Move = (typeof MOVES)[number];

/** The texts of the stage, in the language of the user. */
export interface StageWords {
    readonly moves: Readonly<Record<Move, string>>;
    readonly panes: Readonly<Record<Pane, string>>;
    readonly play: string;
    readonly pause: string;
    readonly speed: string;
    readonly stepsPerSecond: string;
    readonly realTime: string;
    readonly fit: string;
    readonly search: string;
    readonly step: string;
    readonly verdicts: Readonly<Record<Verdict, string>>;
    readonly noProperties: string;
    readonly nothing: string;
}

/** A run whose verdict is compared with that of another one. */
export interface ComparedRun {
    /** Which trace it is, and its verdict. */
    readonly title: string;
    /** What it does where the runs part, and the other one does not. */
    readonly choice: string;
}

/** Two runs side by side, in the language of the user. */
export interface Comparison {
    readonly alignment: Alignment;
    readonly runs: Readonly<Record<SideName, ComparedRun>>;
    /** Up to where the runs part, there, and after it. */
    readonly before: string;
    readonly at: string;
    readonly after: string;
    /** The button that goes to where the runs part. */
    readonly goToParting: string;
    readonly step: string;
}

export type ToStage =
    /** The first message, if the stage shows two runs. */
    | { readonly to: "compare"; readonly comparison: Comparison }
    /** For the stage of the second run. */
    | { readonly to: "there"; readonly message: ToStage }
    | { readonly to: PicturePane; readonly message: ToView }
    | { readonly to: "timeline"; readonly message: ToTimeline }
    /** `shown` are those of the panes that are shown first. */
    | {
          readonly to: "words";
          readonly words: StageWords;
          readonly panes: readonly Pane[];
          readonly shown: readonly Pane[];
      }
    | { readonly to: "stopped"; readonly state: StageState }
    | { readonly to: "ended" }
    | { readonly to: "moments"; readonly asked: MomentsRequest; readonly moments: readonly Moment[] | null };

export type FromStage =
    /** From the stage of the second run. */
    | { readonly from: "there"; readonly message: FromStage }
    | { readonly from: PicturePane; readonly message: FromView }
    | { readonly from: "timeline"; readonly message: FromTimeline }
    | { readonly from: "ready" }
    | { readonly from: "move"; readonly move: Move }
    | { readonly from: "ask"; readonly asked: MomentsRequest }
    | { readonly from: "jump"; readonly place: Place };
