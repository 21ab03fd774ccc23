// SPDX-License-Identifier: Apache-2.0
/** Which states of two runs that are compared belong together. Independent of VS Code and of the page. */

import type { Axis } from "../timeline/contract";

/** Where a run parts from the other one, and the number of steps after which it ends. */
export interface Side {
    /** The number of steps before the turn that differs. */
    readonly step: number;
    /** The time of this turn, in s; null if the model has no clock. */
    readonly time: number | null;
    readonly end: number;
}

/** `pairs` are numbers of steps after which both runs have finished a common turn, ascending. */
export interface Alignment {
    readonly pairs: readonly (readonly [here: number, there: number])[];
    readonly here: Side;
    readonly there: Side;
}

export type SideName = "here" | "there";

/** A position of a run on the axis of its steps or its time. */
export interface Target {
    readonly axis: Axis;
    readonly position: number;
}

/** Times are rounded; a state at the time itself is included, in s. */
const ROUNDING_S = 1e-9;

/** The same alignment, seen from the other run. */
export function reversed({ pairs, here, there }: Alignment): Alignment {
    return { pairs: pairs.map(([one, other]) => [other, one] as const), here: there, there: here };
}

/**
 * The position in the other run that belongs to a state of the first one. Up to the turn that differs, both have finished
 * the same turns. After it, the same time has passed on the axis of times, and the same number of steps on that of steps.
 */
export function counterpart(
    { pairs, here, there }: Alignment,
    at: { readonly step: number; readonly time: number | null },
    axis: Axis,
): Target {
    if (at.step === here.step) return { axis: "steps", position: there.step };
    if (at.step < here.step) {
        const common = pairs.findLast(([one]) => one <= at.step)?.[1] ?? 0;
        return { axis: "steps", position: Math.min(common, there.step) };
    }
    if (axis === "steps" || at.time === null || here.time === null || there.time === null)
        return { axis: "steps", position: there.step + at.step - here.step };
    return { axis: "time", position: there.time + Math.max(0, at.time - here.time) + ROUNDING_S };
}
