// SPDX-License-Identifier: Apache-2.0
/** Chips at the border of the view with the names of the nodes to which lines lead that leave it. */

import type { Box, Drawing, Picture } from "../contract";
import {
    NO_BANDS,
    SIDES,
    CHIP,
    bandsOf,
    chipsOf,
    cornersOf,
    exitsOf,
    hasVisibleEnd,
    inARow,
    type Bands,
    type Chip,
    type DrawnLine,
    type Exit,
    type Side,
} from "./exits";
import { MAP_DISTANCE, beside, gutter, type Sight } from "./find";
import type { Scene } from "./scene";

/** The distance of chips from each other and from the border, and the height of a chip, in pixels. */
const GAP = 4;
const HEIGHT = 19;
/** The distance of chips from the ends of their lines, in pixels. */
const FROM_LINE = 2;
/** Lines within this distance at a border share a chip, in pixels; more if there is no space for the chips. */
const NEAR: Readonly<Record<Side, number>> = { top: 50, bottom: 50, left: 12, right: 12 };
/** The distance of the ends of a chip from the lines that lead to it, in pixels. */
const ROUND = 8;
const ARROWS: Readonly<Record<Side, Readonly<Record<Chip["way"], string>>>> = {
    top: { out: "↑", in: "↓", both: "↕" },
    bottom: { out: "↓", in: "↑", both: "↕" },
    left: { out: "←", in: "→", both: "↔" },
    right: { out: "→", in: "←", both: "↔" },
};
const SIGNS: Readonly<Record<Chip["way"], string>> = { out: "→", in: "←", both: "↔" };

interface ShownLine extends DrawnLine {
    readonly group: SVGGElement;
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
    private drawn = { width: 0, height: 0 };
    /** What is behind the chips and the map at each side, so that they cover nothing. */
    private readonly bands = new Map(SIDES.map((side) => [side, document.createElement("div")]));
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
        this.layer.append(...this.bands.values());
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
            return [{ edge, source: from, target: to, points, group }];
        });
    }

    /** The bands beside a view: those for chips at the sides where lines leave it, and that for the map. */
    bandsOf(sight: Sight, width: number, height: number, map: Size | undefined): Bands {
        const most = this.lines.length > 0 ? bandsOf(sight, this.drawn, width, height) : NO_BANDS;
        const used = new Set(this.exits(sight, width, height, most).map(({ side }) => side));
        const size = (side: Side) => (used.has(side) ? most[side] : 0);
        const right = Math.max(size("right"), map ? gutter(map) : 0);
        return { top: size("top"), bottom: size("bottom"), left: size("left"), right };
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
        this.buttons.clear();
        this.layer.replaceChildren(...this.bands.values());
        for (const band of this.bands.values()) band.removeAttribute("style");
    }

    /** Show the bands of a view with their chips; lines that only lead through it are pale. `map` is the size of the map in the lower right corner. */
    look(sight: Sight, width: number, height: number, bands: Bands, map: Size | undefined): void {
        for (const [side, band] of this.bands) band.style[isRow(side) ? "height" : "width"] = `${bands[side]}px`;
        const inner = beside(sight, width, height, bands);
        for (const line of this.lines) {
            const isThrough = !hasVisibleEnd(line, this.boxes, inner.sight, inner.width, inner.height);
            line.group.classList.toggle("through", isThrough);
        }
        const exits = this.exits(sight, width, height, bands);
        const shown = new Set<string>();
        for (const side of SIDES) {
            const own = exits.filter((exit) => exit.side === side);
            if (own.length === 0 || bands[side] < HEIGHT) continue;
            const [low, high] = isRow(side)
                ? [bands.left + GAP, width - bands.right - GAP]
                : [bands.top + GAP, height - Math.max(bands.bottom, mapHeight(side, map)) - GAP];
            const sizeOf = (chip: Chip) =>
                isRow(side) ? Math.max(this.sizeOf(this.text(chip)), chip.to - chip.from + 2 * ROUND) : HEIGHT;
            const chips = fitting(own, NEAR[side], high - low, sizeOf);
            const things = chips.map((chip) => ({ at: (chip.from + chip.to) / 2, size: sizeOf(chip) }));
            const places = inARow(things, low, high, GAP);
            for (const [index, chip] of chips.entries()) {
                const key = `${side} ${chip.way} ${chip.exits.map(({ edge }) => edge).join(" ")}`;
                shown.add(key);
                const { style } = this.buttons.get(key) ?? this.made(key, chip);
                style[isRow(side) ? "left" : "top"] = `${places[index] ?? 0}px`;
                if (isRow(side)) style.width = `${things[index]?.size ?? 0}px`;
                if (side === "top" || side === "bottom") style[side] = `${bands[side] - HEIGHT - FROM_LINE}px`;
                else if (side === "left") style.right = `${width - bands.left + FROM_LINE}px`;
                else style.left = `${width - bands.right + FROM_LINE}px`;
            }
        }
        for (const [key, button] of this.buttons)
            if (!shown.has(key)) {
                button.remove();
                this.buttons.delete(key);
            }
    }

    private label(node: number): string {
        return this.picture?.nodes[node]?.label ?? "";
    }

    private text({ side, way, exits }: Chip): string {
        const most = isRow(side) ? 2 : 1;
        const names = exits.slice(0, most).map(({ node }) => this.label(node));
        const more = exits.length > most ? ` +${exits.length - most}` : "";
        return `${ARROWS[side][way]} ${names.join(", ")}${more}`;
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
        if (!isRow(chip.side)) button.style.maxWidth = `${CHIP - 2 * FROM_LINE}px`;
        button.title = `${SIGNS[chip.way]} ${names.join(", ")}`;
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

/** The chips of exits that fit into a length, of which each is for lines within a distance if possible. */
function fitting(
    exits: readonly Exit[],
    distance: number,
    length: number,
    sizeOf: (chip: Chip) => number,
): readonly Chip[] {
    const chips = chipsOf(exits, distance);
    const needed = chips.reduce((sum, chip) => sum + sizeOf(chip) + GAP, 0);
    return needed <= length || distance > length ? chips : fitting(exits, 1.5 * distance, length, sizeOf);
}

function isRow(side: Side): boolean {
    return side === "top" || side === "bottom";
}

/** What the map covers at a side, in pixels. */
function mapHeight(side: Side, map: Size | undefined): number {
    return side === "right" && map ? map.height + 2 * MAP_DISTANCE : 0;
}
