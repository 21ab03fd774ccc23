// SPDX-License-Identifier: Apache-2.0
/** Chips at the border of the view with the names of the nodes to which lines lead that leave it. */

import type { Box, Drawing, Picture } from "../contract";
import {
    NO_BANDS,
    SIDES,
    bandsOf,
    LEADER,
    cornersOf,
    exitsOf,
    hasVisibleEnd,
    isWhole,
    placedChips,
    type Bands,
    type Chip,
    type DrawnLine,
    type Exit,
    type PlacedChip,
    type Side,
} from "./exits";
import { MAP_DISTANCE, beside, gutter, type Sight } from "./find";
import { element, type Scene } from "./scene";

/** The distance of chips from each other and from the border, and the height of a chip, in pixels. */
const GAP = 4;
const HEIGHT = 19;
/** Lines within this distance at a border share a chip, in pixels; more if there is no space for the chips. */
const NEAR: Readonly<Record<Side, number>> = { top: 50, bottom: 50, left: 12, right: 12 };
/** The minimum distance of the ends of a chip from the lines that lead to it, in pixels. */
const ROUND: Readonly<Record<Side, number>> = { top: 8, bottom: 8, left: 5, right: 5 };
/** The sizes of the smallest bands with chips, in pixels: in narrower ones, no name could be read. */
const LEAST: Readonly<Record<Side, number>> = { top: HEIGHT, bottom: HEIGHT, left: 80, right: 80 };
const ARROWS: Readonly<Record<Side, readonly [out: string, into: string]>> = {
    top: ["↑", "↓"],
    bottom: ["↓", "↑"],
    left: ["←", "→"],
    right: ["→", "←"],
};

interface ShownLine extends DrawnLine {
    readonly group: SVGGElement;
}

interface ShownLabel {
    readonly group: SVGGElement;
    readonly box: Box;
    /** The lines of the label. */
    readonly lines: readonly ShownLine[];
}

interface Size {
    readonly width: number;
    readonly height: number;
}

export class ExitChips {
    readonly layer = document.createElement("div");
    private picture: Picture | undefined;
    private lines: readonly ShownLine[] = [];
    private boxes: ReadonlyMap<number, Box> = new Map();
    /** The labels of lines, of which those that the border of a view would cut are hidden. */
    private labels: readonly ShownLabel[] = [];
    private drawn = { width: 0, height: 0 };
    /** What is behind the chips and the map at each side, so that they cover nothing. */
    private readonly bands = new Map(SIDES.map((side) => [side, document.createElement("div")]));
    private readonly leaders = element("svg", { class: "leaders scene", "aria-hidden": "true" });
    private readonly buttons = new Map<string, HTMLButtonElement>();
    private readonly sizes = new Map<string, number>();

    /**
     * `choose` is called with the node of a chip that is pressed, `point` with the edge of the chip that has the pointer
     * or the focus, or -1.
     */
    constructor(
        private readonly choose: (node: number) => void,
        private readonly point: (edges: readonly number[]) => void,
    ) {
        this.layer.className = "exits";
        for (const [side, band] of this.bands) band.className = `band is-${side}`;
        this.layer.append(...this.bands.values(), this.leaders);
    }

    /** Take the lines of a drawing. Trees have none: their order says what is beside the view. */
    show(picture: Picture, drawing: Drawing, scene: Scene): void {
        this.picture = picture;
        this.boxes = new Map(drawing.nodes.map((node) => [node.index, node]));
        this.drawn = drawing;
        const index = new Map(picture.nodes.map(({ id }, number) => [id, number]));
        const links =
            picture.kind === "tree"
                ? []
                : scene.root.querySelectorAll<SVGGElement>(":scope > :is(.link, .edge)[data-edges]");
        this.lines = [...links].flatMap((group) => {
            const edge = Number(group.dataset["edges"]?.split(" ")[0]);
            const { source = "", target = "" } = picture.edges[edge] ?? {};
            const [from, to] = [index.get(source), index.get(target)];
            if (from === undefined || to === undefined) return [];
            const paths = [...group.querySelectorAll(":scope > .line")];
            const points = paths.flatMap((path) => cornersOf(path.getAttribute("d") ?? ""));
            group.append(...gapsOf(paths));
            return [{ edge, source: from, target: to, points, group }];
        });
        this.labels = this.lines.length === 0 ? [] : this.labelsOf(scene);
    }

    private labelsOf({ root }: Scene): ShownLabel[] {
        return [...root.querySelectorAll<SVGGElement>(":scope > :is(.label, .line-name)")].map((group) => {
            const edges = [group, ...group.querySelectorAll<SVGGElement>("[data-edges]")].flatMap(({ dataset }) =>
                dataset["edges"] === undefined ? [] : dataset["edges"].split(" ").map(Number),
            );
            const lines = this.lines.filter(({ edge }) => edges.includes(edge));
            return { group, box: group.getBBox(), lines };
        });
    }

    /** The bands beside a view: those for chips at the sides where lines leave it, and that for the map. */
    bandsOf(sight: Sight, width: number, height: number, map: Size | undefined): Bands {
        if (this.lines.length === 0) return { ...NO_BANDS, right: map ? gutter(map) : 0 };
        const most = bandsOf(sight, this.drawn, width, height);
        const right = (size: number) => Math.max(size, map ? gutter(map) : 0);
        let bands = { ...most, right: right(most.right) };
        // In narrower bands, other lines may leave the view.
        for (let pass = 0; pass < 2; pass++) {
            const exits = this.exits(sight, width, height, bands);
            const size = (side: Side) => {
                const sizes = exits.filter((exit) => exit.side === side).map(({ node }) => this.widthOf(side, node));
                return sizes.length === 0 ? 0 : isRow(side) ? most[side] : Math.min(most[side], Math.max(...sizes));
            };
            bands = { top: size("top"), bottom: size("bottom"), left: size("left"), right: right(size("right")) };
        }
        return bands;
    }

    /** The width that a chip needs beside a picture, with its leader, in pixels. */
    private widthOf(side: Side, node: number): number {
        return LEADER + this.sizeOf(`${ARROWS[side][0]} ${this.label(node)}`) + GAP;
    }

    /** The places where lines to named nodes leave a view, in pixels of the window. */
    private exits(sight: Sight, width: number, height: number, bands: Bands): Exit[] {
        const inner = beside(sight, width, height, bands);
        return exitsOf(this.lines, this.boxes, inner.sight, inner.width, inner.height)
            .filter(({ node }) => this.label(node) !== "")
            .map((exit) => ({ ...exit, at: exit.at + (isRow(exit.side) ? bands.left : bands.top) }));
    }

    clear(): void {
        this.lines = [];
        this.labels = [];
        this.buttons.clear();
        this.leaders.replaceChildren();
        this.layer.replaceChildren(...this.bands.values(), this.leaders);
        for (const band of this.bands.values()) band.removeAttribute("style");
    }

    /** Show the bands of a view with their chips; lines that only lead through it are hidden. `map` is the size of the map in the lower right corner. */
    look(sight: Sight, width: number, height: number, bands: Bands, map: Size | undefined): void {
        for (const [side, band] of this.bands) band.style[isRow(side) ? "height" : "width"] = `${bands[side]}px`;
        const inner = beside(sight, width, height, bands);
        for (const line of this.lines) {
            const isThrough = !hasVisibleEnd(line, this.boxes, inner.sight, inner.width, inner.height);
            line.group.classList.toggle("through", isThrough);
            line.group.classList.remove("unlabelled");
        }
        for (const { group, box, lines } of this.labels) {
            const isCut = !isWhole(box, inner.sight, inner.width, inner.height);
            const isThrough = lines.length > 0 && lines.every((line) => line.group.classList.contains("through"));
            group.classList.toggle("through", isCut || isThrough);
            if (isCut) for (const line of lines) line.group.classList.add("unlabelled");
        }
        const exits = this.exits(sight, width, height, bands);
        const shown = new Set<string>();
        this.leaders.replaceChildren();
        for (const side of SIDES) {
            const own = exits.filter((exit) => exit.side === side);
            if (own.length === 0 || bands[side] < LEAST[side]) continue;
            const [low, high] = isRow(side)
                ? [bands.left + GAP, width - bands.right - GAP]
                : [bands.top + GAP, height - Math.max(bands.bottom, mapHeight(side, map)) - GAP];
            const sizeOf = (chip: Chip) => (isRow(side) ? this.sizeOf(this.text(chip)) : HEIGHT);
            const row = { low, high, gap: GAP, round: ROUND[side], sizeOf };
            // The border between the picture and the band.
            const border = {
                top: bands.top,
                bottom: height - bands.bottom,
                left: bands.left,
                right: width - bands.right,
            };
            for (const placed of placedChips(own, NEAR[side], row)) {
                shown.add(this.place(placed, border[side], width, bands));
                this.leaders.append(...this.leadersOf(placed, border[side]));
            }
        }
        for (const [key, button] of this.buttons)
            if (!shown.has(key)) {
                button.remove();
                this.buttons.delete(key);
            }
    }

    /** Show a chip at its place, and return its key. */
    private place({ chip, start, size }: PlacedChip, border: number, width: number, bands: Bands): string {
        const { side, isOut, exits } = chip;
        const key = `${side} ${isOut} ${exits.map(({ edge }) => edge).join(" ")}`;
        const { style } = this.buttons.get(key) ?? this.made(key, chip);
        style[isRow(side) ? "left" : "top"] = `${start}px`;
        if (isRow(side)) style.width = `${size}px`;
        else style.maxWidth = `${bands[side] - LEADER}px`;
        if (side === "top") style.top = `${border - LEADER - HEIGHT}px`;
        else if (side === "bottom") style.top = `${border + LEADER}px`;
        else if (side === "left") style.right = `${width - border + LEADER}px`;
        else style.left = `${border + LEADER}px`;
        return key;
    }

    /** The lines from a border to a chip, which look like the lines that they continue. */
    private leadersOf({ chip: { side, exits }, leaders }: PlacedChip, border: number): SVGGElement[] {
        const outside = border + (side === "top" || side === "left" ? -LEADER : LEADER);
        return leaders.map(({ exit, end }) => {
            const [from, to] = isRow(side)
                ? [`${exit.at} ${border}`, `${end} ${outside}`]
                : [`${border} ${exit.at}`, `${outside} ${end}`];
            const look = this.lines.find(({ edge }) => edge === exit.edge)?.group.getAttribute("class") ?? "";
            const group = element("g", { class: look, "data-exit": exit.edge });
            group.dataset["chip"] = exits.map(({ node }) => this.label(node)).join("\n");
            group.append(element("path", { class: "line", d: `M ${from} L ${to}` }));
            return group;
        });
    }

    private label(node: number): string {
        return this.picture?.nodes[node]?.label ?? "";
    }

    private text({ side, isOut, exits }: Chip): string {
        const most = isRow(side) ? 2 : 1;
        const names = exits.slice(0, most).map(({ node }) => this.label(node));
        const more = exits.length > most ? ` +${exits.length - most}` : "";
        return `${ARROWS[side][isOut ? 0 : 1]} ${names.join(", ")}${more}`;
    }

    private sizeOf(text: string): number {
        const known = this.sizes.get(text);
        if (known !== undefined) return known;
        const sample = document.createElement("button");
        sample.className = "exit";
        sample.textContent = text;
        this.layer.append(sample);
        const { width } = sample.getBoundingClientRect();
        sample.remove();
        this.sizes.set(text, width);
        return width;
    }

    private made(key: string, chip: Chip): HTMLButtonElement {
        const button = document.createElement("button");
        button.className = `exit is-${chip.side}`;
        button.textContent = this.text(chip);
        const names = chip.exits.map(({ node }) => this.label(node));
        button.title = `${chip.isOut ? "→" : "←"} ${names.join(", ")}`;
        button.setAttribute("aria-label", button.title);
        const edges = chip.exits.map(({ edge }) => edge);
        button.addEventListener("click", () => {
            this.point([]);
            this.choose(chip.exits[0]?.node ?? -1);
        });
        for (const begin of ["pointerenter", "focus"])
            button.addEventListener(begin, () => {
                this.point(edges);
            });
        for (const end of ["pointerleave", "blur"])
            button.addEventListener(end, () => {
                this.point([]);
            });
        this.buttons.set(key, button);
        this.layer.append(button);
        return button;
    }
}

/** The parts of a line below its label, which are drawn while the label is hidden. */
function gapsOf(paths: readonly Element[]): SVGPathElement[] {
    return paths.slice(1).flatMap((path, index) => {
        const [end] = cornersOf(paths[index]?.getAttribute("d") ?? "").slice(-1);
        const [start] = cornersOf(path.getAttribute("d") ?? "");
        if (!end || !start) return [];
        return [element("path", { class: "line gap", d: `M ${end.x} ${end.y} L ${start.x} ${start.y}` })];
    });
}

function isRow(side: Side): boolean {
    return side === "top" || side === "bottom";
}

/** What the map covers at a side, in pixels. */
function mapHeight(side: Side, map: Size | undefined): number {
    return side === "right" && map ? map.height + 2 * MAP_DISTANCE : 0;
}
