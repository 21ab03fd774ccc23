// SPDX-License-Identifier: Apache-2.0
/** A small map of a drawing that is larger than the view. A click or a drag moves the visible part. */

import type { Drawing, Picture, Point } from "../contract";
import { toneOf } from "./words";
import { centered, mapOf, type MapScale, type Sight } from "./find";
import { element } from "./scene";

/** The size of the largest map, in pixels. */
const LARGEST = { width: 200, height: 300 };

export class Minimap {
    readonly svg = element("svg", { class: "minimap", "aria-hidden": "true" });
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
        this.scale = mapOf(drawing, LARGEST.width, LARGEST.height);
        const { width, height, factor } = this.scale;
        this.svg.setAttribute("width", String(width));
        this.svg.setAttribute("height", String(height));
        this.svg.replaceChildren(
            ...drawing.nodes.map(({ index, ...box }) =>
                element("rect", {
                    class: `minimap-node tone-${toneOf(picture.nodes[index]?.kind)}`,
                    "data-map-node": index,
                    x: box.x * factor,
                    y: box.y * factor,
                    width: Math.max(2, box.width * factor),
                    height: Math.max(2, box.height * factor),
                }),
            ),
            this.frame,
        );
    }

    /** Show which part is visible. The map is hidden if all of the drawing is visible. */
    look(sight: Sight, width: number, height: number): void {
        this.sight = sight;
        this.view = { width, height };
        if (!this.drawing || !this.scale) return;
        const seen = { width: width / sight.scale, height: height / sight.scale };
        const all = seen.width >= this.drawing.width && seen.height >= this.drawing.height;
        this.svg.classList.toggle("hidden", all);
        const { factor } = this.scale;
        const [left, top] = [Math.max(0, sight.x * factor), Math.max(0, sight.y * factor)];
        const right = Math.min(this.scale.width, (sight.x + seen.width) * factor);
        const bottom = Math.min(this.scale.height, (sight.y + seen.height) * factor);
        this.frame.setAttribute("x", String(left));
        this.frame.setAttribute("y", String(top));
        this.frame.setAttribute("width", String(Math.max(0, right - left)));
        this.frame.setAttribute("height", String(Math.max(0, bottom - top)));
    }

    /** Emphasise nodes, such as those that a search has found. */
    mark(nodes: readonly number[]): void {
        for (const node of this.svg.querySelectorAll<SVGRectElement>("[data-map-node]"))
            node.classList.toggle("found", nodes.includes(Number(node.dataset["mapNode"])));
    }

    clear(): void {
        this.drawing = undefined;
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
