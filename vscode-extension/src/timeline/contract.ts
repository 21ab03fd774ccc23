// SPDX-License-Identifier: Apache-2.0
/** The data of a timeline from the debug adapter, and the messages between the extension and the view that shows it. */

import type { Theme } from "../pictures/contract";

export type Axis = "time" | "steps";

export const EXPORTS = ["svg", "mermaid", "csv"] as const;
export type ExportFormat = (typeof EXPORTS)[number];

/** The part of a timeline that is asked for; positions are on the axis, in s or steps, the others in pixels. */
export interface TileRequest {
    readonly axis: Axis;
    readonly from: number;
    /** The end of the run if missing. */
    readonly to?: number;
    readonly width: number;
    readonly top: number;
    readonly bottom: number;
    readonly names: boolean;
    /** The names of the curves that are drawn over each other. */
    readonly curves: readonly string[];
    /** Whether parts without a name are drawn together, without hints. */
    readonly coarse: boolean;
}

/** The answer to the request `timeline` (docs/debugging.md). */
export interface Tile {
    readonly scene: string;
    readonly names?: string;
    /** The meaning of the colors, with `names`. */
    readonly legend?: string;
    readonly legendHeight?: number;
    /** The names of the curves, with `names`. */
    readonly plots?: readonly string[];
    /** The ids of the nodes in pictures that belong to each lane, with `names`; one that ends with # is a beginning. */
    readonly lanes?: readonly (readonly string[])[];
    readonly from: number;
    readonly to: number;
    readonly width: number;
    readonly height: number;
    readonly extent: number;
    readonly hasTime: boolean;
    readonly step: number;
    readonly steps: number;
    readonly cursor: number;
    readonly first: number;
}

/** The texts of the view, in the language of the user. */
export interface TimelineWords {
    readonly zoomIn: string;
    readonly zoomOut: string;
    readonly fit: string;
    readonly selection: string;
    readonly time: string;
    readonly steps: string;
    readonly exports: Readonly<Record<ExportFormat, string>>;
    /** The menu of the curves that are drawn over each other. */
    readonly curves: string;
    readonly noCurves: string;
    readonly help: string;
    readonly nothing: string;
}

export type ToTimeline =
    | { readonly type: "words"; readonly words: TimelineWords }
    /** The run has stopped at another position. */
    | { readonly type: "stopped" }
    | { readonly type: "ended" }
    | { readonly type: "tile"; readonly asked: TileRequest; readonly tile: Tile | null };

export type FromTimeline =
    | { readonly type: "ready" }
    | { readonly type: "ask"; readonly asked: TileRequest }
    /** Go to a step, or to the last step up to a position on the axis. */
    | { readonly type: "goToStep"; readonly step: number }
    | { readonly type: "goTo"; readonly axis: Axis; readonly position: number }
    | {
          readonly type: "export";
          readonly format: ExportFormat;
          readonly axis: Axis;
          readonly from: number;
          readonly to: number;
          readonly curves: readonly string[];
          readonly theme: Theme;
      };
