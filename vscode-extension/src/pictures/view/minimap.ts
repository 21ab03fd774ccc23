// SPDX-License-Identifier: Apache-2.0
/** A small map of a drawing that is larger than the view. A click or a drag moves the visible part. */

import type { Drawing, Picture, Point } from "../contract";
import { toneOf } from "./words";
import { LARGEST_MAP, centered, mapOf, visiblePart } from "./find";
import type { MapScale, Sight } from "./find";
import { element } from "./scene";

/** A smaller window has no space for a map, in pixels. */
const SMALLEST_WINDOW = { width: 280, height: 220 };

export class Minimap {
    readonly svg = element("svg", { class: "minimap hidden", "aria-hidden": "true" });
    private readonly frame = element("rect", { class: "minimap-frame" });
    private drawing: Drawing | undefined;
    private scale: MapScale | undefined;
    private view = { width: 0, height: 0 };
    private sight: Sight = { x: 0, y: 0, scale: 1 };
    constructor(move: (sight: Sight) => void) {
        const center = (event: PointerEvent) => {
            const point = this.pointAt(event);
            if (point) move(centered(this.sight, point, this.view.width, this.view.height));
        };
        this.svg.addEventListener("pointerdown", (event) => {
            if (event.button !== 0) return;
            event.stopPropagation();
            this.svg.setPointerCapture(event.pointerId);
            center(event);
        });
        this.svg.addEventListener("pointermove", (event) => {
            if (this.svg.hasPointerCapture(event.pointerId)) center(event);
        });
    }

    /** Draw the nodes of a picture. */
    show(picture: Picture, drawing: Drawing): void {
        this.drawing = drawing;
        this.svg.setAttribute("viewBox", `0 0 ${drawing.width} ${drawing.height}`);
        const parents = new Set(picture.nodes.map(({ parent }) => parent));
        this.svg.replaceChildren(
            ...drawing.nodes.map(({ index, ...box }) => {
                const { id = "", kind } = picture.nodes[index] ?? {};
                const outer = parents.has(id) ? " is-outer" : "";
                const look = `minimap-node tone-${toneOf(kind)}${outer}`;
                return element("rect", { class: look, "data-map-node": index, ...box });
            }),
            this.frame,
        );
    }

    /** Show which part is visible. The map is hidden if all of the drawing is visible. */
    look(sight: Sight, width: number, height: number): void {
        this.sight = sight;
        this.view = { width, height };
        if (!this.drawing) return;
        const part = visiblePart(sight, this.drawing, width, height);
        const isWhole = part.width >= this.drawing.width && part.height >= this.drawing.height;
        const isSmall = width < SMALLEST_WINDOW.width || height < SMALLEST_WINDOW.height;
        const [most, highest] = [Math.min(LARGEST_MAP.width, width / 5), Math.min(LARGEST_MAP.height, height / 2)];
        this.scale = isWhole || isSmall ? undefined : mapOf(this.drawing, most, highest);
        this.svg.classList.toggle("hidden", !this.scale);
        if (this.scale) place(this.svg, { width: this.scale.width, height: this.scale.height });
        place(this.frame, { ...part });
    }

    /** The size of the map; undefined if it is hidden. */
    get size(): MapScale | undefined {
        return this.scale;
    }

    /** Emphasise nodes, such as those that a search has found. */
    mark(nodes: readonly number[]): void {
        for (const node of this.svg.querySelectorAll<SVGRectElement>("[data-map-node]"))
            node.classList.toggle("found", nodes.includes(Number(node.dataset["mapNode"])));
    }

    clear(): void {
        this.drawing = this.scale = undefined;
        this.svg.classList.add("hidden");
        this.svg.replaceChildren();
    }

    private pointAt(event: PointerEvent): Point | undefined {
        if (!this.scale) return undefined;
        const { left, top } = this.svg.getBoundingClientRect();
        return {
            x: (event.clientX - left) / this.scale.factor,
            y: (event.clientY - top) / this.scale.factor,
        };
    }
}

function place(shape: SVGElement, attributes: Readonly<Record<string, number>>): void {
    for (const [name, value] of Object.entries(attributes)) shape.setAttribute(name, String(value));
}
