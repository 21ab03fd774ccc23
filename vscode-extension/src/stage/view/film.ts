// SPDX-License-Identifier: Apache-2.0
/** A run that is played: which moments are needed, and which one is shown. Independent of the page and of clocks. */

import type { Axis } from "../../timeline/contract";
import type { Moment, MomentsRequest } from "../contract";

/** How fast a run is played: steps, or seconds of the model, in one second. */
export interface Speed {
    readonly axis: Axis;
    readonly rate: number;
}

export const SPEEDS: readonly Speed[] = [
    { axis: "steps", rate: 1 },
    { axis: "steps", rate: 4 },
    { axis: "steps", rate: 16 },
    { axis: "steps", rate: 64 },
    { axis: "time", rate: 0.1 },
    { axis: "time", rate: 1 },
    { axis: "time", rate: 10 },
];

/** More moments in a second are not seen. */
const MOMENTS_PER_S = 20;
const COUNT = 40;
/** So many seconds of playing are asked for in advance. */
const AHEAD_S = 1;

export class Film {
    private readonly moments: Moment[] = [];
    private readonly by: number;
    /** The position up to which the moments are known. */
    private known: number;
    private pending = false;
    private hasEnd = false;
    position: number;

    /** `from` is a position on the axis of the speed, `step` the step of the state there. */
    constructor(
        readonly speed: Speed,
        from: number,
        private readonly step: number,
    ) {
        const least = speed.axis === "steps" ? 1 : 0;
        this.by = Math.max(least, speed.rate / MOMENTS_PER_S);
        this.position = from;
        this.known = from - this.by;
    }

    /** What to ask for now; undefined if enough is known. */
    wants(): MomentsRequest | undefined {
        if (this.pending || this.hasEnd || this.known > this.position + AHEAD_S * this.speed.rate) return undefined;
        this.pending = true;
        return { axis: this.speed.axis, from: this.known + this.by, by: this.by, count: COUNT, after: this.last };
    }

    /** Add the answer to a request; null if there is none, which ends the film. */
    add(asked: MomentsRequest, moments: readonly Moment[] | null): void {
        this.pending = false;
        this.moments.push(...(moments ?? []));
        this.hasEnd = moments === null || moments.some(({ isEnd, stop }) => isEnd || stop !== null);
        this.known = asked.from + asked.by * (asked.count - 1);
    }

    /** Play for a time in s. Without moments, the film waits. */
    play(seconds: number): void {
        const end = this.hasEnd ? (this.moments.at(-1)?.position ?? this.position) : this.known;
        this.position = Math.max(this.position, Math.min(this.position + seconds * this.speed.rate, end));
    }

    /** The last step that is known. */
    private get last(): number {
        return this.moments.at(-1)?.step ?? this.step;
    }

    /** The moment at the position; undefined while it is the one at the beginning. */
    get shown(): Moment | undefined {
        let [low, high] = [0, this.moments.length];
        while (low < high) {
            const middle = (low + high) >> 1;
            if ((this.moments[middle]?.position ?? Infinity) <= this.position) low = middle + 1;
            else high = middle;
        }
        return this.moments[low - 1];
    }

    get isOver(): boolean {
        return this.hasEnd && (this.moments.length === 0 || this.shown === this.moments.at(-1));
    }
}
