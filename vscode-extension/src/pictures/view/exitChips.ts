// SPDX-License-Identifier: Apache-2.0
/** Chips at the border of the view with the names of the nodes to which lines lead that leave it. */

import type { Box, Drawing, Picture } from "../contract";
import {
    NO_BANDS,
    SIDES,
    bandsOf,
    chipsOf,
    cornersOf,
    exitsOf,
    inARow,
    type Bands,
    type Chip,
    type DrawnLine,
    type Exit,
    type Side,
} from "./exits";
import type { Corner, Sight } from "./find";
import type { Scene } from "./scene";

/** The distance of chips from each other and from the border, and the height of a chip, in pixels. */
const GAP = 4;
const HEIGHT = 19;
/** Lines within this distance at a border share a chip, in pixels; more if there is no space for the chips. */
const NEAR: Readonly<Record<Side, number>> = { top: 50, bottom: 50, left: 12, right: 12 };
const MAX_NAMES = 2;
const ARROWS: Readonly<Record<Side, readonly [string, string]>> = {
    top: ["↑", "↓"],
    bottom: ["↓", "↑"],
    left: ["←", "→"],
    right: ["→", "←"],
};

export class ExitChips {
    readonly layer = document.createElement("div");
    private picture: Picture | undefined;
    private lines: readonly DrawnLine[] = [];
    private boxes: ReadonlyMap<number, Box> = new Map();
    private drawn = { width: 0, height: 0 };
    /** What is behind the chips at the upper and the lower side, so that they cover no name. */
    private readonly bands = { top: document.createElement("div"), bottom: document.createElement("div") };
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
        for (const side of ["top", "bottom"] as const) this.bands[side].className = `band is-${side}`;
        this.layer.append(this.bands.top, this.bands.bottom);
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
            return [
                { edge, source: from, target: to, points: paths.flatMap((p) => cornersOf(p.getAttribute("d") ?? "")) },
            ];
        });
    }

    /** What chips cover in a view; nothing if the picture has none. */
    bandsOf(sight: Sight, width: number, height: number): Bands {
        return this.lines.length > 0 ? bandsOf(sight, this.drawn, width, height) : NO_BANDS;
    }

    clear(): void {
        this.lines = [];
        this.buttons.clear();
        this.layer.replaceChildren(this.bands.top, this.bands.bottom);
    }

    /** Show the chips of a view, beside the map. */
    look(sight: Sight, width: number, height: number, map: Corner | undefined): void {
        const { top, bottom } = this.bandsOf(sight, width, height);
        const inner = { ...sight, y: sight.y + top / sight.scale };
        const named = exitsOf(this.lines, this.boxes, inner, width, height - top - bottom).filter(
            ({ node }) => this.label(node) !== "",
        );
        const shown = new Set<string>();
        for (const side of SIDES) {
            const isRow = side === "top" || side === "bottom";
            const own = named
                .filter((exit) => exit.side === side)
                .map((exit) => (isRow ? exit : { ...exit, at: exit.at + top }));
            if (isRow) this.bands[side].classList.toggle("hidden", own.length === 0);
            if (own.length === 0) continue;
            const [low, high] = limits(side, isRow ? width : height, map);
            const sizeOf = (chip: Chip) => (isRow ? this.sizeOf(this.text(chip)) : HEIGHT);
            const chips = fitting(own, NEAR[side], high - low, sizeOf);
            const things = chips.map((chip) => ({ at: chip.at, size: sizeOf(chip) }));
            const places = inARow(things, low, high, GAP);
            for (const [index, chip] of chips.entries()) {
                const key = `${side} ${chip.isOut} ${chip.exits.map(({ edge }) => edge).join(" ")}`;
                shown.add(key);
                const button = this.buttons.get(key) ?? this.made(key, chip);
                button.style[isRow ? "left" : "top"] = `${places[index] ?? 0}px`;
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

    private text({ side, isOut, exits }: Chip): string {
        const names = exits.slice(0, MAX_NAMES).map(({ node }) => this.label(node));
        const more = exits.length > MAX_NAMES ? ` +${exits.length - MAX_NAMES}` : "";
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
        button.className = `exit is-${chip.side} ${chip.isOut ? "leaves" : "enters"}`;
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

/** The part of a side that chips may use, in pixels: not the corners, and not what the map covers. */
function limits(side: Side, length: number, map: Corner | undefined): readonly [number, number] {
    const isRow = side === "top" || side === "bottom";
    const corner = isRow ? GAP : HEIGHT + 2 * GAP;
    const isBeside = map && (isRow ? map.isTop === (side === "top") : map.isLeft === (side === "left"));
    if (!isBeside) return [corner, length - corner];
    const covered = isRow ? map.width : map.height;
    const isAtStart = isRow ? map.isLeft : map.isTop;
    return isAtStart ? [Math.max(corner, covered), length - corner] : [corner, length - Math.max(corner, covered)];
}
