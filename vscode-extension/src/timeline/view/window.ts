// SPDX-License-Identifier: Apache-2.0
/** The visible part of the axis, and how it moves. */

import type { Tile } from "../contract";

export interface Stretch {
    readonly from: number;
    readonly to: number;
}

/** The least visible part of the axis, as a part of all. */
const LEAST = 1e-6;

export function pan({ from, to }: Stretch, by: number, extent: number): Stretch {
    const span = to - from;
    const start = Math.min(Math.max(from + by, 0), Math.max(0, extent - span));
    return { from: start, to: start + span };
}

/** Zoom about a position that stays where it is. */
export function zoom({ from, to }: Stretch, factor: number, about: number, extent: number): Stretch {
    const span = Math.min(Math.max((to - from) / factor, extent * LEAST), extent);
    const part = to > from ? (about - from) / (to - from) : 0;
    return pan({ from: about - part * span, to: about - part * span + span }, 0, extent);
}

/** Show a position: nothing changes if it is visible, otherwise it is in the middle. */
export function reveal(stretch: Stretch, position: number, extent: number): Stretch {
    if (stretch.from <= position && position <= stretch.to) return stretch;
    return pan(stretch, position - (stretch.from + stretch.to) / 2, extent);
}

/** The part that is asked for: what is visible, and `margin` times as much on each side. */
export function withMargins({ from, to }: Stretch, margin: number, width: number): Stretch & { width: number } {
    const span = to - from;
    const part = grown({ from, to }, margin);
    return { ...part, width: span > 0 ? (width * (part.to - part.from)) / span : width };
}

/** Whether a tile has all that is visible, and `margin` times as much on each side. */
export function contains(tile: Stretch, visible: Stretch, margin: number): boolean {
    const { from, to } = grown(visible, margin);
    return tile.from <= from && to <= tile.to;
}

/** Whether a tile has the scale of the view, so that it is not stretched. */
export function isSharp(tile: Pick<Tile, "from" | "to" | "width">, { from, to }: Stretch, width: number): boolean {
    const scale = width / (to - from) / (tile.width / (tile.to - tile.from));
    return Math.abs(scale - 1) < 0.01;
}

function grown({ from, to }: Stretch, margin: number): Stretch {
    const by = margin * (to - from);
    return { from: Math.max(0, from - by), to: to + by };
}
