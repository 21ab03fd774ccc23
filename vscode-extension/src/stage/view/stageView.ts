// SPDX-License-Identifier: Apache-2.0
/** The stage: the pictures of a run, its timeline and its properties, with one toolbar. */

import type { FromView } from "../../pictures/contract";
import { PictureView } from "../../pictures/view/pictureView";
import type { Axis } from "../../timeline/contract";
import { TimelineView } from "../../timeline/view/timelineView";
import {
    MOVES,
    PICTURES,
    type FromStage,
    type Moment,
    type Move,
    type Pane,
    type PicturePane,
    type StageProperty,
    type StageState,
    type StageWords,
    type ToStage,
} from "../contract";
import { Film, SPEEDS } from "./film";
import { icon } from "./icons";

/** A pane is small, and shows what happens with its surroundings. */
const LEAST_SCALE = 0.6;
const VERDICT_SIGNS = { passed: "✓", failed: "✗", undecided: "…" } as const;

export class StageView {
    readonly bar = element("div", "bar stage-bar");
    private readonly caption = element("div", "caption");
    private readonly grid = element("div", "stage-grid");
    private readonly position = element("span", "position");
    private readonly playButton = element("button", "play");
    private readonly speed = document.createElement("select");
    private readonly properties = element("ul", "stage-properties");
    private readonly panes = new Map<Pane, HTMLElement>();
    private readonly pictures = new Map<PicturePane, PictureView>();
    private readonly timeline: TimelineView;
    private readonly hidden = new Set<Pane>();
    private words: StageWords | undefined;
    private state: StageState | undefined;
    private film: Film | undefined;
    private shown: Moment | undefined;
    /** Called with each state that is shown, also while it is played. */
    onShown: (at: StageState | Moment, isPlayed: boolean) => void = () => undefined;
    /** The stage that the toolbar also changes. */
    private follower: StageView | undefined;
    /** The stage whose toolbar is used instead of that of this one. */
    private leader: StageView | undefined;
    /** Why playing has ended. */
    private reason = "";
    private lastFrame = 0;

    constructor(
        private readonly root: HTMLElement,
        private readonly post: (message: FromStage) => void,
    ) {
        this.caption.setAttribute("role", "status");
        root.classList.add("run-stage");
        root.append(this.bar, this.caption, this.grid);
        for (const pane of PICTURES) {
            const send = (message: FromView) => {
                post({ from: pane, message });
            };
            const view = new PictureView(this.addPane(pane), send, LEAST_SCALE);
            view.onSelect = (node) => {
                this.timeline.light(node);
                this.timeline.revealLane();
            };
            this.pictures.set(pane, view);
        }
        this.addPane("properties").append(this.properties);
        this.timeline = new TimelineView(this.addPane("timeline"), (message) => {
            // To ask for the next part of a long run does not end playing.
            if (message.type === "goTo" || message.type === "goToStep") this.stop(false);
            post({ from: "timeline", message });
        });
        root.addEventListener("keydown", (event) => {
            if (this.key(event)) event.preventDefault();
        });
    }

    receive(message: ToStage): void {
        switch (message.to) {
            case "words":
                this.begin(message.words, message.panes, message.shown);
                break;
            case "timeline":
                this.timeline.receive(message.message);
                break;
            case "stopped":
                this.show(message.state);
                break;
            case "ended":
                this.stop(false);
                this.state = undefined;
                this.caption.textContent = this.words?.nothing ?? "";
                this.position.textContent = "";
                this.properties.replaceChildren();
                break;
            case "moments":
                this.film?.add(message.asked, message.moments);
                break;
            case "system":
            case "tree":
            case "ros":
                this.pictures.get(message.to)?.receive(message.message);
                break;
            case "compare":
            case "there":
                break; // for the page with two stages
        }
    }

    /** Let the toolbar of this stage change another one as well, which shows a second run. */
    lead(follower: StageView): void {
        this.follower = follower;
        follower.leader = this;
        this.timeline.lead(follower.timeline);
    }

    /** The timeline, whose keys go to a step; otherwise the first picture that is shown. */
    get focusable(): HTMLElement | SVGElement | undefined {
        if (!this.hidden.has("timeline")) return this.timeline.focusable;
        return PICTURES.filter((pane) => !this.hidden.has(pane)).map((pane) => this.pictures.get(pane)?.focusable)[0];
    }

    /** The axis of the timeline. */
    get axis(): Axis {
        return this.timeline.axis;
    }

    get isAtEnd(): boolean {
        return this.state?.isEnd === true;
    }

    /** Mark a position of the run in the timeline. */
    mark(step: number, time: number | null, text: string): void {
        this.timeline.mark({ step, time }, text);
    }

    private addPane(pane: Pane): HTMLElement {
        const section = element("section", `pane pane-${pane}`);
        const content = element("div", "pane-content");
        section.append(element("h2", "pane-title"), content);
        this.panes.set(pane, section);
        this.grid.append(section);
        return content;
    }

    private begin(words: StageWords, panes: readonly Pane[], shown: readonly Pane[]): void {
        this.words = words;
        for (const [pane, section] of this.panes) {
            section.setAttribute("aria-label", words.panes[pane]);
            const title = section.querySelector(".pane-title");
            if (title) title.textContent = words.panes[pane];
            if (!shown.includes(pane)) this.hidden.add(pane);
        }
        this.fillBar(words, panes);
        this.arrange();
    }

    /** Lay out the panes that are shown: pictures above, timeline and properties below. */
    private arrange(): void {
        for (const [pane, section] of this.panes) section.hidden = this.hidden.has(pane);
        const above = PICTURES.filter((pane) => !this.hidden.has(pane)).length;
        this.grid.dataset["above"] = String(above);
        this.grid.dataset["below"] = String(
            Number(!this.hidden.has("timeline")) + Number(!this.hidden.has("properties")),
        );
    }

    private show(state: StageState): void {
        this.stop(false);
        this.state = state;
        this.root.dataset["step"] = String(state.step);
        this.caption.textContent = [this.reason, state.next].filter((text) => text !== "").join(" · ");
        this.reason = "";
        this.showPosition(state.step, state.time);
        this.showProperties(state.properties);
        this.onShown(state, false);
    }

    private showPosition(step: number, time: number | null): void {
        const { words } = this;
        if (words)
            this.position.textContent = `${words.step} ${step}` + (time === null ? "" : ` · ${time.toFixed(3)} s`);
    }

    private showProperties(properties: readonly StageProperty[]): void {
        const { words } = this;
        if (!words) return;
        if (properties.length === 0) this.properties.textContent = words.noProperties;
        else this.properties.replaceChildren(...properties.map((property) => this.entry(property, words)));
    }

    private entry({ name, text, verdict, place }: StageProperty, words: StageWords): HTMLElement {
        const item = element("li", `verdict-${verdict}`);
        const button = element("button", "property");
        const sign = element("span", "sign");
        sign.textContent = VERDICT_SIGNS[verdict];
        const label = element("span", "property-text");
        label.textContent = text === "" ? name : text;
        button.append(sign, label);
        button.title = `${name}: ${words.verdicts[verdict]}`;
        button.setAttribute("aria-label", `${name}: ${words.verdicts[verdict]}. ${text}`);
        button.addEventListener("click", () => {
            if (place) this.post({ from: "jump", place });
        });
        item.append(button);
        return item;
    }

    // ------------------------------------------------------------------- playing

    private toggle(): void {
        if (this.leader) this.leader.toggle();
        else if (this.film) this.stop(true);
        else this.play();
    }

    private play(): void {
        const speed = SPEEDS[Number(this.speed.value)];
        const { state } = this;
        if (!speed || !state) return;
        const from = speed.axis === "time" ? state.time : state.step;
        if (from === null) return;
        this.film = new Film(speed, from, state.step);
        this.shown = undefined;
        this.lastFrame = performance.now();
        this.showPlaying();
        requestAnimationFrame(this.frame);
    }

    private readonly frame = (now: number): void => {
        const { film } = this;
        if (!film) return;
        const asked = film.wants();
        if (asked) this.post({ from: "ask", asked });
        film.play((now - this.lastFrame) / 1000);
        this.lastFrame = now;
        const moment = film.shown;
        const at = moment ?? this.state;
        if (at) {
            const { axis } = film.speed;
            const step = axis === "steps" ? film.position : at.step;
            this.timeline.play({ step, time: axis === "time" ? film.position : at.time });
        }
        if (moment && moment !== this.shown) this.showMoment(moment);
        if (film.isOver) this.stop(true);
        else requestAnimationFrame(this.frame);
    };

    /** End playing; the run stays where it is. */
    pause(): void {
        this.stop(false);
    }

    /** Show a state without moving the run. */
    preview(moment: Moment): void {
        this.timeline.play(moment);
        this.showMoment(moment);
    }

    private showMoment(moment: Moment): void {
        const before = this.shown;
        this.shown = moment;
        for (const [pane, view] of this.pictures)
            if (!this.hidden.has(pane)) view.receive({ type: "activity", activity: moment.activity[pane] });
        this.showPosition(moment.step, moment.time);
        this.root.dataset["step"] = String(moment.step);
        const properties = this.state?.properties ?? [];
        if (JSON.stringify(before?.verdicts) !== JSON.stringify(moment.verdicts))
            this.showProperties(
                properties.map((one) => ({ ...one, verdict: moment.verdicts[one.name] ?? one.verdict })),
            );
        this.reason = moment.stop ?? "";
        this.onShown(moment, true);
    }

    /** End playing. With `goes`, the debugger goes to what is shown, so that all other views show it, too. */
    private stop(goes: boolean): void {
        if (!this.film) return;
        this.film = undefined;
        this.showPlaying();
        const step = this.shown?.step;
        if (goes && step !== undefined) this.post({ from: "timeline", message: { type: "goToStep", step } });
    }

    private showPlaying(): void {
        const { words, film } = this;
        if (!words) return;
        const text = film ? words.pause : words.play;
        this.playButton.replaceChildren(icon(film ? "pause" : "play"));
        this.playButton.title = text;
        this.playButton.setAttribute("aria-label", text);
    }

    // ------------------------------------------------------------------- the user

    /** Whether the stage has handled a key that no pane has handled. */
    private key(event: KeyboardEvent): boolean {
        const { key, target, ctrlKey, metaKey, altKey, defaultPrevented } = event;
        if (defaultPrevented || ctrlKey || metaKey || altKey) return false;
        if (target instanceof HTMLElement && target.closest("input, select, button, details")) return false;
        if (key === "p") this.toggle();
        else if (key === ",") this.move("stepBack");
        else if (key === ".") this.move("stepForward");
        else return false;
        return true;
    }

    private move(move: Move): void {
        if (this.leader) this.leader.move(move);
        else if (this.film) this.stop(true);
        else this.post({ from: "move", move });
    }

    /** This stage, and the one that its toolbar also changes. */
    private get stages(): readonly StageView[] {
        return this.follower ? [this, this.follower] : [this];
    }

    private showPane(pane: Pane, isShown: boolean): void {
        if (isShown) this.hidden.delete(pane);
        else this.hidden.add(pane);
        this.arrange();
    }

    private fit(): void {
        for (const [pane, view] of this.pictures) if (!this.hidden.has(pane)) view.fit();
        this.timeline.fit();
    }

    private fillBar(words: StageWords, panes: readonly Pane[]): void {
        const button = (content: string | Node, title: string, run: () => void) => {
            const made = element("button", "");
            made.append(content);
            made.title = title;
            made.setAttribute("aria-label", title);
            made.addEventListener("click", run);
            return made;
        };
        const moves = MOVES.map((move) =>
            button(icon(move), words.moves[move], () => {
                this.move(move);
            }),
        );
        this.playButton.addEventListener("click", () => {
            this.toggle();
        });
        this.speed.setAttribute("aria-label", words.speed);
        this.speed.title = words.speed;
        this.speed.replaceChildren(
            ...SPEEDS.map(({ axis, rate }, index) => {
                const text = axis === "steps" ? `${rate} ${words.stepsPerSecond}` : `${words.realTime} × ${rate}`;
                return new Option(text, String(index), index === 1, index === 1);
            }),
        );
        this.speed.addEventListener("change", () => {
            if (!this.film) return;
            this.stop(true);
        });
        const toggles = panes.map((pane) => {
            const made = button(words.panes[pane], words.panes[pane], () => {
                const isShown = this.hidden.has(pane);
                for (const stage of this.stages) stage.showPane(pane, isShown);
                made.setAttribute("aria-pressed", String(isShown));
            });
            made.setAttribute("aria-pressed", String(!this.hidden.has(pane)));
            return made;
        });
        const search = document.createElement("input");
        search.type = "search";
        search.placeholder = words.search;
        search.setAttribute("aria-label", words.search);
        search.addEventListener("input", () => {
            for (const { pictures } of this.stages) for (const view of pictures.values()) view.find(search.value);
        });
        const fit = button(words.fit, words.fit, () => {
            for (const stage of this.stages) stage.fit();
        });
        const movement = group("movement", ...moves.slice(0, 3), this.playButton, ...moves.slice(3), this.speed);
        this.bar.replaceChildren(
            movement,
            this.position,
            group("toggles", ...toggles),
            this.timeline.bar,
            group("looking", search, fit),
        );
        this.showPlaying();
    }
}

function group(name: string, ...parts: readonly HTMLElement[]): HTMLElement {
    const made = element("div", `group ${name}`);
    made.setAttribute("role", "group");
    made.append(...parts);
    return made;
}

export function element<K extends keyof HTMLElementTagNameMap>(tag: K, name: string): HTMLElementTagNameMap[K] {
    const made = document.createElement(tag);
    made.className = name;
    return made;
}
