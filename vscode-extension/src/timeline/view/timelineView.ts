// SPDX-License-Identifier: Apache-2.0
/**
 * The view of the timeline. The debug adapter draws the visible part and its surroundings; scrolling and zooming move
 * that drawing at once, and a new one replaces it as soon as it comes.
 */

import { EXPORTS, type Axis, type FromTimeline, type Tile, type TileRequest, type TimelineWords } from "../contract";
import type { ToTimeline } from "../contract";
import { contains, isSharp, pan, reveal, withMargins, zoom, type Stretch } from "./window";
import { CurvesMenu } from "./curvesMenu";
import { theme } from "../../pictures/view/theme";

const ZOOM = 1.5;
type Rows = Pick<TileRequest, "top" | "bottom">;
/** What is drawn around the visible part: so many times its width on each side, and rows in pixels. */
interface Margin {
    readonly times: number;
    readonly rows: number;
}
/** A position of a run that is played; the step may lie between two steps. `time` is null if the model has no clock. */
export interface Played {
    readonly step: number;
    readonly time: number | null;
}
const MARGIN: Margin = { times: 1, rows: 400 };
/** While the user zooms, a drawing is soon replaced, and a small one is drawn and shown faster. */
const ZOOM_MARGIN: Margin = { times: 0.25, rows: 60 };
/** After this time without zooming, a coarse drawing is replaced, in ms. */
const SETTLED = 120;
/** A new drawing is needed when less than this remains. */
const LEAST_MARGIN: Margin = { times: 0.1, rows: 20 };
/** A pointer that moves less has clicked. */
const CLICK = 4;

export class TimelineView {
    readonly bar = div("bar");
    private readonly curves = new CurvesMenu((chosen) => {
        this.choose(chosen);
        this.follower?.choose(chosen);
    });
    private curvesChosen: readonly string[] = [];
    private readonly body = div("body");
    private readonly names = div("names");
    private readonly rows = div("rows");
    private readonly colors = div("colors");
    private readonly drawing = div("drawing");
    private readonly cursor = div("cursor-line");
    private readonly selected = div("selected-stretch");
    private readonly litLane = div("lit-lane");
    /** A position of the run that is marked. */
    private readonly marked = div("marked-line");
    private marking: Played | undefined;
    /** The timeline of another run, which has the same axis and curves. */
    private follower: TimelineView | undefined;
    private readonly notice = div("notice");
    private lanes: readonly (readonly string[])[] = [];
    private lit = "";
    private words: TimelineWords | undefined;
    axis: Axis = "time";
    private visible: Stretch = { from: 0, to: 0 };
    private selection: Stretch | undefined;
    /** Where the selection with the keyboard began. */
    private anchor: number | undefined;
    private tile: Tile | undefined;
    /** The rows that the tile has, in pixels. */
    private drawn: Rows = { top: 0, bottom: 0 };
    /** Whether the tile is coarse, as while the user zooms. */
    private isCoarse = false;
    /** Replaces a coarse tile when the user has stopped zooming. */
    private settling: ReturnType<typeof setTimeout> | undefined;
    /** What is played, instead of the position of the debugger. */
    private played: Played | undefined;
    private pending = false;
    private hasChanged = true;
    private drag: { x: number; at: number; selects: boolean; moved: boolean } | undefined;

    /** `root` is the element that the view fills. */
    constructor(
        private readonly root: HTMLElement,
        private readonly post: (message: FromTimeline) => void,
    ) {
        this.notice.setAttribute("role", "status");
        this.rows.tabIndex = 0;
        this.rows.setAttribute("role", "application");
        this.marked.hidden = true;
        this.rows.append(this.litLane, this.drawing, this.selected, this.marked, this.cursor);
        this.body.append(this.names, this.rows);
        root.append(this.bar, this.body, this.colors, this.notice);
        this.listen();
        new ResizeObserver(() => {
            this.refresh();
        }).observe(this.body);
    }

    receive(message: ToTimeline): void {
        switch (message.type) {
            case "words":
                this.words = message.words;
                this.fillBar(message.words);
                break;
            case "stopped":
                this.hasChanged = true;
                this.played = undefined;
                this.refresh();
                break;
            case "ended":
                this.tile = undefined;
                this.drawing.replaceChildren();
                this.names.replaceChildren();
                this.colors.replaceChildren();
                this.notice.textContent = this.words?.nothing ?? "";
                this.root.classList.remove("shown");
                break;
            case "tile":
                this.pending = false;
                if (message.tile) this.show(message.asked, message.tile);
                else if (this.hasChanged) this.refresh(); // asked while the run moved, which has stopped since then
                break;
        }
    }

    /** Show a position that is played. If the run has grown beyond the drawing, another one is asked for. */
    play(played: Played): void {
        this.played = played;
        const { tile } = this;
        if (!tile) return;
        const cursor = this.cursorAt;
        if (cursor > tile.extent && !this.pending) this.hasChanged = true;
        this.visible = reveal(this.visible, cursor, Math.max(this.extent, cursor));
        this.refresh();
    }

    /** Let the buttons of this timeline change another one as well. */
    lead(follower: TimelineView): void {
        this.follower = follower;
    }

    /** Mark a position of the run, and say why. */
    mark(position: Played, text: string): void {
        this.marking = position;
        this.marked.title = text;
        this.marked.dataset["text"] = text;
        this.place();
    }

    /** The element that handles the keys. */
    get focusable(): HTMLElement {
        return this.rows;
    }

    private choose(curves: readonly string[]): void {
        this.curvesChosen = curves;
        this.hasChanged = true;
        this.refresh();
    }

    /** Mark the lane of a node of a picture; "" marks none. */
    light(node: string): void {
        this.lit = node;
        const belongs = (id: string) => (id.endsWith("#") ? node.startsWith(id) : node === id);
        const lane = this.lanes.findIndex((ids) => ids.some(belongs));
        // The first row is that of the messages.
        const rows = [...this.names.querySelectorAll(".name")].slice(1);
        for (const [index, row] of rows.entries()) row.classList.toggle("lit", index === lane);
        const row = rows[lane];
        this.litLane.hidden = row === undefined;
        if (!row) return;
        const { top, height } = row.getBoundingClientRect();
        const middle = top + height / 2 - this.names.getBoundingClientRect().top;
        this.litLane.style.top = `${middle - this.litLane.offsetHeight / 2}px`;
    }

    /** Show the marked lane, if there is one. */
    revealLane(): void {
        if (!this.litLane.hidden) this.litLane.scrollIntoView({ block: "nearest" });
    }

    /** The position of the cursor on the axis. */
    private get cursorAt(): number {
        return (this.axis === "time" ? this.played?.time : this.played?.step) ?? this.tile?.cursor ?? 0;
    }

    private get width(): number {
        return Math.max(1, this.rows.clientWidth);
    }

    /** Pixels for each second or step. */
    private get scale(): number {
        return this.width / Math.max(this.visible.to - this.visible.from, 1e-12);
    }

    private get extent(): number {
        return Math.max(this.tile?.extent ?? 0, 1e-9);
    }

    /** Move the drawing to where it belongs, and ask for another one if it lacks something. */
    private refresh(): void {
        this.place();
        const { tile } = this;
        const scales = tile !== undefined && !isSharp(tile, this.visible, this.width);
        if (this.pending || this.width < 50) return;
        if (tile && !scales && !this.hasChanged && this.hasAround(tile, LEAST_MARGIN)) {
            if (this.isCoarse) this.settle();
            return;
        }
        this.ask(scales);
    }

    private settle(): void {
        clearTimeout(this.settling);
        this.settling = setTimeout(() => {
            if (this.isCoarse && !this.pending) this.ask(false);
        }, SETTLED);
    }

    /** Ask for a drawing of the visible part and its surroundings. */
    private ask(scales: boolean): void {
        const { tile } = this;
        clearTimeout(this.settling);
        const margin = scales ? ZOOM_MARGIN : MARGIN;
        const part = tile ? withMargins(this.visible, margin.times, this.width) : { from: 0, width: this.width };
        this.pending = true;
        this.post({
            type: "ask",
            asked: {
                ...part,
                ...this.rowsWith(margin),
                axis: this.axis,
                width: Math.round(part.width),
                names: this.hasChanged || !tile,
                curves: this.curvesChosen,
                coarse: scales,
            },
        });
        this.hasChanged = false;
    }

    private rowsWith({ rows }: Margin): Rows {
        const { scrollTop, clientHeight } = this.body;
        return { top: scrollTop - rows, bottom: scrollTop + clientHeight + rows };
    }

    private hasAround(tile: Tile, margin: Margin): boolean {
        const { top, bottom } = this.rowsWith(margin);
        return contains(tile, this.visible, margin.times) && this.drawn.top <= top && bottom <= this.drawn.bottom;
    }

    /** The distance by which the numbers of the axis are moved down, in pixels. */
    private axisTop = 0;

    private show(asked: TileRequest, tile: Tile): void {
        const before = this.tile;
        if (asked.axis !== this.axis) return;
        this.tile = tile;
        this.drawn = asked;
        this.isCoarse = asked.coarse;
        if (!tile.hasTime) this.axis = "steps";
        if (!before) {
            // The first answer says how long the run is.
            this.visible = { from: 0, to: Math.max(tile.extent, 1e-9) };
            this.hasChanged = true;
        } else if (before.step !== tile.step || before.extent !== tile.extent) {
            const showedAll = this.visible.from <= 0 && this.visible.to >= before.extent;
            this.visible = showedAll
                ? { from: 0, to: Math.max(tile.extent, 1e-9) }
                : reveal(this.visible, tile.cursor, this.extent);
        }
        const { anchor } = this;
        if (anchor !== undefined)
            this.selection = { from: Math.min(anchor, tile.cursor), to: Math.max(anchor, tile.cursor) };
        this.root.classList.add("shown");
        this.notice.textContent = "";
        this.drawing.innerHTML = picture(tile.scene, tile.width, tile.height);
        if (tile.names !== undefined) this.names.innerHTML = picture(tile.names, NAMES_WIDTH, tile.height);
        if (tile.legend !== undefined)
            this.colors.innerHTML = picture(tile.legend, LEGEND_WIDTH, tile.legendHeight ?? 0);
        if (tile.plots) this.curves.offer(tile.plots);
        if (tile.lanes) this.lanes = tile.lanes;
        this.light(this.lit);
        this.axisTop = 0;
        this.rows.style.height = `${tile.height}px`;
        this.cursor.style.height = `${tile.height}px`;
        const label = this.words ? `${this.words.steps} ${tile.step}. ${this.words.help}` : "";
        this.rows.setAttribute("aria-label", label);
        this.root.dataset["step"] = String(tile.step);
        this.refresh();
    }

    private place(): void {
        const { tile } = this;
        if (!tile) return;
        const x = (position: number) => (position - this.visible.from) * this.scale;
        const stretch = (x(tile.to) - x(tile.from)) / tile.width;
        this.drawing.style.transform = `translateX(${x(tile.from)}px) scaleX(${stretch})`;
        this.cursor.style.transform = `translateX(${x(this.cursorAt)}px)`;
        const marking = this.axis === "time" ? this.marking?.time : this.marking?.step;
        this.marked.hidden = marking === undefined || marking === null;
        this.marked.style.height = `${tile.height}px`;
        this.marked.style.transform = `translateX(${x(marking ?? 0)}px)`;
        this.placeAxis();
        this.selected.hidden = !this.selection;
        if (this.selection) {
            this.selected.style.left = `${x(this.selection.from)}px`;
            this.selected.style.width = `${Math.max(1, x(this.selection.to) - x(this.selection.from))}px`;
        }
    }

    /** Keep the numbers of the axis above the rows. A change in the drawing is painted anew, so it is made only if needed. */
    private placeAxis(): void {
        const { scrollTop } = this.body;
        if (scrollTop === this.axisTop) return;
        this.axisTop = scrollTop;
        for (const axis of this.drawing.querySelectorAll(".axis-names"))
            axis.setAttribute("transform", `translate(0 ${scrollTop})`);
    }

    private look(visible: Stretch): void {
        this.visible = visible;
        this.refresh();
    }

    private zoom(factor: number, about?: number): void {
        const middle = (this.visible.from + this.visible.to) / 2;
        this.look(zoom(this.visible, factor, about ?? middle, this.extent));
    }

    fit(): void {
        this.look({ from: 0, to: this.extent });
    }

    /** The position on the axis below the pointer. */
    private at({ clientX }: MouseEvent): number {
        return this.visible.from + (clientX - this.rows.getBoundingClientRect().left) / this.scale;
    }

    private switchAxis(axis: Axis): void {
        if (axis === this.axis || this.tile?.hasTime === false) return;
        this.axis = axis;
        // Positions in the old drawing have another unit.
        this.tile = undefined;
        this.drawing.replaceChildren();
        this.anchor = undefined;
        this.selection = undefined;
        this.pending = false;
        this.hasChanged = true;
        for (const button of this.bar.querySelectorAll<HTMLElement>("[data-axis]"))
            button.setAttribute("aria-pressed", String(button.dataset["axis"] === axis));
        this.refresh();
    }

    // ------------------------------------------------------------------- the user

    private listen(): void {
        this.body.addEventListener("scroll", () => {
            this.refresh();
        });
        this.body.addEventListener(
            "wheel",
            (event) => {
                const isZoom = event.ctrlKey || event.metaKey;
                const sideways = event.shiftKey ? event.deltaY + event.deltaX : event.deltaX;
                if (!isZoom && sideways === 0) return;
                event.preventDefault();
                if (isZoom) this.zoom(Math.exp(-event.deltaY / 200), this.at(event));
                else this.look(pan(this.visible, sideways / this.scale, this.extent));
            },
            { passive: false },
        );
        this.rows.addEventListener("pointerdown", (event) => {
            if (event.button !== 0) return;
            this.rows.setPointerCapture(event.pointerId);
            this.anchor = undefined;
            this.drag = { x: event.clientX, at: this.at(event), selects: event.shiftKey, moved: false };
        });
        this.rows.addEventListener("pointermove", (event) => {
            const { drag } = this;
            if (!drag) return;
            drag.moved ||= Math.abs(event.clientX - drag.x) > CLICK;
            if (!drag.moved) return;
            if (drag.selects) {
                const [from, to] = [drag.at, this.at(event)].sort((one, other) => one - other) as [number, number];
                this.selection = { from: Math.max(0, from), to: Math.min(this.extent, to) };
                this.place();
            } else this.look(pan(this.visible, -event.movementX / this.scale, this.extent));
        });
        this.rows.addEventListener("pointerup", (event) => {
            const { drag } = this;
            this.drag = undefined;
            if (!drag || drag.moved || !this.tile) return;
            const below = document.elementFromPoint(event.clientX, event.clientY);
            const step = below?.closest<SVGElement>(".event[data-step]")?.dataset["step"];
            if (step === undefined) this.post({ type: "goTo", axis: this.axis, position: drag.at });
            else this.post({ type: "goToStep", step: Number(step) });
        });
        this.rows.addEventListener("keydown", (event) => {
            if (this.key(event)) event.preventDefault();
        });
    }

    /** Whether the view has handled the key. */
    private key({ key, ctrlKey, metaKey, shiftKey }: KeyboardEvent): boolean {
        if (ctrlKey || metaKey || !this.tile) return false;
        const { step, steps, cursor } = this.tile;
        const goal = { ArrowLeft: Math.max(0, step - 1), ArrowRight: step + 1, Home: 0, End: steps }[key];
        if (goal !== undefined) {
            this.anchor = shiftKey ? (this.anchor ?? cursor) : undefined;
            this.post({ type: "goToStep", step: goal });
        } else if (key === "+" || key === "=") this.zoom(ZOOM, this.tile.cursor);
        else if (key === "-") this.zoom(1 / ZOOM, this.tile.cursor);
        else if (key === "0") this.fit();
        else if (key === "Escape") {
            this.anchor = undefined;
            this.selection = undefined;
            this.place();
        } else return false;
        return true;
    }

    private fillBar(words: TimelineWords): void {
        const button = (text: string, title: string, run: () => void) => {
            const made = document.createElement("button");
            made.textContent = text;
            made.title = title;
            made.setAttribute("aria-label", title);
            made.addEventListener("click", run);
            return made;
        };
        const axes = (["time", "steps"] as const).map((axis) => {
            const made = button(words[axis], words[axis], () => {
                this.switchAxis(axis);
                this.follower?.switchAxis(axis);
            });
            made.dataset["axis"] = axis;
            made.setAttribute("aria-pressed", String(axis === this.axis));
            return made;
        });
        this.curves.name(words);
        const zooms = [
            button("+", words.zoomIn, () => {
                this.zoom(ZOOM);
            }),
            button("−", words.zoomOut, () => {
                this.zoom(1 / ZOOM);
            }),
            button(words.fit, words.fit, () => {
                this.fit();
            }),
        ];
        const exports = [
            button(words.selection, words.selection, () => {
                if (this.selection && this.selection.to > this.selection.from) this.look(this.selection);
            }),
            ...EXPORTS.map((format) =>
                button({ svg: "SVG", mermaid: "Mermaid", csv: "CSV" }[format], words.exports[format], () => {
                    const part = this.selection ?? { from: 0, to: this.extent };
                    const options = { ...part, curves: this.curvesChosen, theme: theme() };
                    this.post({ type: "export", format, axis: this.axis, ...options });
                }),
            ),
        ];
        for (const each of zooms) each.classList.add("zoom");
        for (const each of exports) each.classList.add("export");
        this.bar.replaceChildren(...axes, this.curves.menu, ...zooms, ...exports);
    }
}

const NAMES_WIDTH = 180;
/** The width of the legend, as the debug adapter draws it, in pixels. */
const LEGEND_WIDTH = 480;

function div(name: string): HTMLDivElement {
    const made = document.createElement("div");
    made.className = name;
    return made;
}

/** The text of a scene as HTML, which is parsed in half the time of XML. */
function picture(scene: string, width: number, height: number): string {
    return `<svg width="${width}" height="${height}">${scene}</svg>`;
}
