// SPDX-License-Identifier: Apache-2.0
/**
 * The stages of two runs side by side, with one toolbar. The run in which the user goes to a state leads, and the other one
 * goes to the state that belongs to it.
 */

import { counterpart, reversed, type SideName } from "../alignment";
import type { Comparison, FromStage, Moment, MomentsRequest, StageState, ToStage } from "../contract";
import { element, StageView } from "./stageView";

/** What is asked for to find one state; films ask for more. */
const ONE = { by: 1, count: 1 };

/** A state of a run, and whether it is only shown, because the run is played. */
interface ShownState {
    readonly at: StageState | Moment;
    readonly isPlayed: boolean;
}

export class ComparedStages {
    private readonly status = element("div", "bar compare-status");
    private readonly sides: Readonly<Record<SideName, HTMLElement>>;
    private readonly here: StageView;
    private readonly there: StageView;
    private leader: SideName = "here";
    /** The state of the leader to which the other run has yet to go. */
    private next: ShownState | undefined;
    /** The state for which the counterpart has been asked. */
    private asked: ShownState | undefined;
    private atThere: number | undefined;

    constructor(
        root: HTMLElement,
        private readonly post: (message: FromStage) => void,
        private readonly comparison: Comparison,
    ) {
        root.classList.add("compared");
        this.sides = { here: this.side("here"), there: this.side("there") };
        this.here = new StageView(this.sides.here, (message) => {
            this.send("here", message);
        });
        this.there = new StageView(this.sides.there, (message) => {
            this.send("there", message);
        });
        this.here.lead(this.there);
        const [status, button, both] = [
            element("span", ""),
            element("button", "go-to-parting"),
            element("div", "sides"),
        ];
        status.setAttribute("role", "status");
        button.textContent = comparison.goToParting;
        button.addEventListener("click", () => {
            this.goToParting();
        });
        this.status.append(status, button);
        both.append(this.sides.here, this.sides.there);
        root.append(this.here.bar, this.status, both);
        for (const side of ["here", "there"] as const) {
            const { step, time } = comparison.alignment[side];
            this[side].mark(step, time, comparison.goToParting);
            this[side].onShown = (at, isPlayed) => {
                this.shown(side, at, isPlayed);
            };
        }
    }

    receive(message: ToStage): void {
        const [side, inner] =
            message.to === "there" ? (["there", message.message] as const) : (["here", message] as const);
        if (inner.to === "moments" && inner.asked.count === ONE.count) this.found(side, inner.moments?.at(-1));
        else this[side].receive(inner);
    }

    get focusable(): HTMLElement | SVGElement | undefined {
        return this.here.focusable;
    }

    private side(side: SideName): HTMLElement {
        const { title, choice } = this.comparison.runs[side];
        const made = element("section", `side ${side}`);
        const [heading, text] = [element("h1", "side-title"), element("div", "side-choice")];
        const name = element("span", "side-name");
        name.textContent = title;
        name.title = title;
        heading.append(name, element("span", "side-position"));
        text.textContent = choice;
        text.title = choice;
        made.setAttribute("aria-label", title);
        made.append(heading, text);
        return made;
    }

    /** A message of a stage. The one in which the user moves leads. */
    private send(side: SideName, message: FromStage): void {
        const moves =
            message.from === "move" || (message.from === "timeline" && message.message.type.startsWith("goTo"));
        if (moves) {
            this.lead(side);
            if (side === "there") this.here.pause();
            // At the end of the first run, the second one goes on.
            const isForward = message.from === "move" && message.move === "stepForward";
            if (isForward && this.here.isAtEnd && this.atThere !== undefined) {
                this.lead("there");
                this.goTo("there", this.atThere + 1);
                return;
            }
        }
        this.post(side === "there" ? { from: "there", message } : message);
    }

    /** Let a run lead. A state of the other one, for which nothing has been asked yet, is of no use then. */
    private lead(side: SideName): void {
        if (side !== this.leader) this.next = undefined;
        this.leader = side;
    }

    private goToParting(): void {
        this.lead("here");
        this.here.pause();
        this.goTo("here", this.comparison.alignment.here.step);
    }

    private goTo(side: SideName, step: number): void {
        const message: FromStage = { from: "timeline", message: { type: "goToStep", step } };
        this.post(side === "there" ? { from: "there", message } : message);
    }

    private shown(side: SideName, at: StageState | Moment, isPlayed: boolean): void {
        if (side === "there") this.atThere = at.step;
        const position = this.sides[side].querySelector(".side-position");
        const time = at.time === null ? "" : ` · ${at.time.toFixed(3)} s`;
        if (position) position.textContent = `${this.comparison.step} ${at.step}${time}`;
        const parting = this.comparison.alignment[side].step;
        const where = at.step < parting ? "before" : at.step === parting ? "at" : "after";
        this.sides[side].dataset["where"] = where;
        if (side === this.leader) {
            this.say(where);
            this.next = { at, isPlayed };
        }
        this.follow();
    }

    /** Say whether the runs still do the same. */
    private say(where: "before" | "at" | "after"): void {
        const text = this.comparison[where];
        const status = this.status.firstElementChild;
        if (status && status.textContent !== text) status.textContent = text;
    }

    /** Look for the state of the other run that belongs to that of the leader. */
    private follow(): void {
        const { next, leader } = this;
        if (!next || this.asked) return;
        this.next = undefined;
        const side = leader === "here" ? "there" : "here";
        this.asked = next;
        const { alignment } = this.comparison;
        const seen = leader === "here" ? alignment : reversed(alignment);
        const { axis, position } = counterpart(seen, next.at, this.here.axis);
        const asked: MomentsRequest = { axis, from: position, ...ONE };
        this.post(side === "there" ? { from: "there", message: { from: "ask", asked } } : { from: "ask", asked });
    }

    /**
     * The state that was asked for; undefined while the run moves. It is asked for again where the run stops. It is of no
     * use if the user has begun to move in this run meanwhile.
     */
    private found(side: SideName, moment: Moment | undefined): void {
        const { asked } = this;
        this.asked = undefined;
        if (side !== this.leader) {
            if (!moment) {
                this.next ??= asked;
                return;
            }
            if (asked?.isPlayed === true) this[side].preview(moment);
            else this.goTo(side, moment.step);
        }
        this.follow();
    }
}
