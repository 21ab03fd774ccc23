// SPDX-License-Identifier: Apache-2.0
/** The view in a panel: draws the pictures that the extension sends, and sends it the actions of the user. */

import ELK from "elkjs/lib/elk.bundled.js";
import type { FromView, Part, Picture, PictureEdge, PictureNode, ToView, Words } from "../contract";
import { draw, element, markers, type Scene } from "./draw";
import { pngData, svgText } from "./exporting";
import { fit, isDirection, neighbour, reveal, search, zoom, type Sight } from "./find";
import { TITLE_SIZE, drawingOf, graphOf, type Drawing } from "./layout";

declare function acquireVsCodeApi(): { postMessage(message: FromView): void };

const editor = acquireVsCodeApi();
const elk = new ELK();
const ZOOM = 1.25;

class View {
    private readonly svg = element("svg", { class: "picture", tabindex: 0, role: "application" });
    private readonly bar = document.createElement("div");
    private readonly input = document.createElement("input");
    private readonly legend = document.createElement("div");
    private readonly notice = document.createElement("div");
    private words: Words | undefined;
    private picture: Picture | undefined;
    private drawing: Drawing | undefined;
    private scene: Scene | undefined;
    private sight: Sight = { x: 0, y: 0, scale: 1 };
    private selected = -1;
    private here: Part | null = null;
    private asked = 0;

    constructor() {
        this.bar.className = "bar";
        this.legend.className = "legend";
        this.notice.className = "notice";
        this.notice.setAttribute("role", "status");
        this.svg.append(markers());
        document.body.append(this.svg, this.bar, this.legend, this.notice);
        this.listen();
    }

    receive(message: ToView): void {
        switch (message.type) {
            case "words":
                this.words = message.words;
                this.fillBar(message.words);
                break;
            case "show":
                void this.show(message.picture, message.here, message.highlighted);
                break;
            case "here":
                this.mark(message.here);
                break;
            case "highlight":
                this.highlight(message.node);
                break;
            case "none":
                this.asked++;
                this.clear();
                this.notice.textContent = message.reason;
                break;
        }
    }

    private async show(picture: Picture, here: Part | null, highlighted: string): Promise<void> {
        const { words } = this;
        if (!words) return;
        const asked = ++this.asked;
        const laidOut = await elk.layout(graphOf(picture, measure(), (node) => words.kinds[node.kind]));
        if (asked !== this.asked) return;
        const isNew = this.picture?.title !== picture.title || this.picture.kind !== picture.kind;
        const label = this.picture?.nodes[this.selected]?.label;
        this.clear();
        this.picture = picture;
        this.drawing = drawingOf(picture, laidOut);
        this.scene = draw(picture, this.drawing, words);
        this.svg.append(this.scene.root);
        this.svg.setAttribute("aria-label", `${picture.title}. ${words.help}`);
        this.fillLegend(picture, words);
        if (isNew) this.fit();
        else this.look(this.sight);
        if (!isNew && label !== undefined) this.select(picture.nodes.findIndex((node) => node.label === label));
        this.mark(here);
        this.highlight(highlighted);
        if (this.input.value !== "") this.search();
        editor.postMessage({ type: "drawn", nodes: picture.nodes.length, edges: picture.edges.length });
    }

    private clear(): void {
        this.scene?.root.remove();
        this.scene = undefined;
        this.picture = undefined;
        this.drawing = undefined;
        this.selected = -1;
        this.notice.textContent = "";
        this.legend.replaceChildren();
    }

    // ------------------------------------------------------------------- looking

    private look(sight: Sight): void {
        this.sight = sight;
        const { x, y, scale } = sight;
        this.scene?.root.setAttribute("transform", `scale(${scale}) translate(${-x} ${-y})`);
    }

    private fit(): void {
        const { width, height } = this.svg.getBoundingClientRect();
        if (this.drawing) this.look(fit(this.drawing, width, height));
    }

    private zoom(factor: number, about?: { x: number; y: number }): void {
        const { width, height } = this.svg.getBoundingClientRect();
        this.look(zoom(this.sight, factor, about ?? { x: width / 2, y: height / 2 }));
    }

    private reveal(node: number): void {
        const box = this.drawing?.nodes.find((each) => each.index === node);
        const { width, height } = this.svg.getBoundingClientRect();
        if (box) this.look(reveal(this.sight, box, width, height));
    }

    // ------------------------------------------------------------------ choosing

    private select(node: number): void {
        this.scene?.nodes.get(this.selected)?.classList.remove("selected");
        this.selected = node;
        const chosen = this.scene?.nodes.get(node);
        chosen?.classList.add("selected");
        if (!chosen) return;
        this.reveal(node);
        this.notice.textContent = "";
        this.svg.setAttribute("aria-label", chosen.getAttribute("aria-label") ?? "");
    }

    /** Select the part that contains the caret. */
    private mark(here: Part | null): void {
        this.part(this.here)?.classList.remove("here");
        this.here = here;
        this.part(here)?.classList.add("here");
        if (here === null || !this.picture) return;
        if ("node" in here) this.reveal(here.node);
        else {
            const edge = this.picture.edges[here.edge];
            this.reveal(this.picture.nodes.findIndex((node) => node.id === edge?.source));
        }
    }

    /** Highlight the node of the current step of a trace. */
    private highlight(id: string): void {
        const highlighted = id === "" ? -1 : (this.picture?.nodes.findIndex((node) => node.id === id) ?? -1);
        for (const [index, node] of this.scene?.nodes ?? [])
            node.classList.toggle("highlighted", index === highlighted);
        if (highlighted >= 0) this.reveal(highlighted);
    }

    private part(part: Part | null): SVGGElement | undefined {
        if (part === null) return undefined;
        return "node" in part ? this.scene?.nodes.get(part.node) : this.scene?.edges.get(part.edge);
    }

    private jump(to: PictureNode | PictureEdge | undefined, beside: boolean): void {
        if (to?.place) editor.postMessage({ type: "jump", place: to.place, beside });
    }

    private search(forward = false): void {
        if (!this.picture || !this.scene) return;
        const found = search(this.picture, this.input.value);
        this.scene.root.classList.toggle("searched", this.input.value.trim() !== "");
        for (const [index, node] of this.scene.nodes) node.classList.toggle("found", found.includes(index));
        this.notice.textContent =
            this.input.value.trim() !== "" && found.length === 0 ? (this.words?.nothing ?? "") : "";
        const next = forward ? found.find((index) => index > this.selected) : undefined;
        const first = next ?? found[0];
        if (first !== undefined) this.select(first);
    }

    // ------------------------------------------------------------------- the user

    private listen(): void {
        this.svg.addEventListener("click", ({ target, ctrlKey, metaKey }) => {
            if (!(target instanceof Element) || !this.scene || !this.picture) return;
            const part = target.closest<SVGGElement>(".node, .edge");
            for (const [index, node] of this.scene.nodes) {
                if (node !== part) continue;
                this.select(index);
                this.jump(this.picture.nodes[index], ctrlKey || metaKey);
            }
            for (const [index, edge] of this.scene.edges) {
                if (edge === part) this.jump(this.picture.edges[index], ctrlKey || metaKey);
            }
        });
        this.svg.addEventListener("dblclick", ({ target }) => {
            if (target === this.svg) this.fit();
        });
        this.svg.addEventListener(
            "wheel",
            (event) => {
                event.preventDefault();
                const { left, top } = this.svg.getBoundingClientRect();
                const about = { x: event.clientX - left, y: event.clientY - top };
                this.zoom(Math.exp(-event.deltaY / 400), about);
            },
            { passive: false },
        );
        this.svg.addEventListener("pointerdown", (event) => {
            if (event.button !== 0 || (event.target instanceof Element && event.target.closest(".node, .edge"))) return;
            this.svg.setPointerCapture(event.pointerId);
            this.svg.classList.add("moving");
        });
        this.svg.addEventListener("pointermove", (event) => {
            if (!this.svg.hasPointerCapture(event.pointerId)) return;
            const { x, y, scale } = this.sight;
            this.look({ scale, x: x - event.movementX / scale, y: y - event.movementY / scale });
        });
        const release = () => {
            this.svg.classList.remove("moving");
        };
        this.svg.addEventListener("pointerup", release);
        this.svg.addEventListener("pointercancel", release);
        document.addEventListener("keydown", (event) => {
            if (this.key(event)) event.preventDefault();
        });
        this.input.addEventListener("input", () => {
            this.search();
        });
    }

    /** Whether the view has handled the key. */
    private key({ key, ctrlKey, metaKey }: KeyboardEvent): boolean {
        const typing = document.activeElement === this.input;
        if (typing) {
            if (key === "Enter") this.search(true);
            else if (key === "Escape") {
                this.input.value = "";
                this.search();
                this.svg.focus();
            } else return false;
            return true;
        }
        if (key === "/" || (key === "f" && (ctrlKey || metaKey))) this.input.focus();
        else if (ctrlKey || metaKey) return false;
        else if (isDirection(key))
            this.select(neighbour(this.drawing?.nodes ?? [], this.selected, key) ?? this.selected);
        else if (key === "Enter") this.jump(this.picture?.nodes[this.selected], false);
        else if (key === "+" || key === "=") this.zoom(ZOOM);
        else if (key === "-") this.zoom(1 / ZOOM);
        else if (key === "0") this.fit();
        else return false;
        return true;
    }

    private fillBar(words: Words): void {
        this.input.type = "search";
        this.input.placeholder = words.search;
        this.input.setAttribute("aria-label", words.search);
        const button = (text: string, title: string, run: () => unknown) => {
            const made = document.createElement("button");
            made.textContent = text;
            made.title = title;
            made.setAttribute("aria-label", title);
            made.addEventListener("click", () => void run());
            return made;
        };
        this.bar.replaceChildren(
            this.input,
            button("+", words.zoomIn, () => {
                this.zoom(ZOOM);
            }),
            button("−", words.zoomOut, () => {
                this.zoom(1 / ZOOM);
            }),
            button(words.fit, words.fit, () => {
                this.fit();
            }),
            button("SVG", words.saveSvg, () => this.save("svg")),
            button("PNG", words.savePng, () => this.save("png")),
        );
    }

    private fillLegend(picture: Picture, words: Words): void {
        const kinds = new Set(picture.edges.filter(({ kind }) => kind !== "child").map(({ kind }) => kind));
        const entries = [...kinds].map((kind) => entry(`is-${kind}`, words.kinds[kind]));
        if (picture.edges.some((edge) => edge.probabilistic)) entries.push(entry("chance", words.byChance));
        this.legend.replaceChildren(...entries);
    }

    private async save(format: "svg" | "png"): Promise<void> {
        if (!this.scene || !this.drawing) return;
        const svg = svgText(this.svg, this.scene.root, this.drawing);
        const data = format === "svg" ? svg : await pngData(svg, this.drawing);
        editor.postMessage({ type: "save", format, data });
    }
}

function entry(className: string, text: string): HTMLElement {
    const made = document.createElement("span");
    const line = element("svg", { width: 28, height: 8, "aria-hidden": "true" });
    const group = element("g", { class: `edge ${className}` });
    group.append(element("path", { d: "M 1 4 H 27", class: "line" }));
    line.append(group);
    made.append(line, text);
    return made;
}

function measure(): (text: string, size: number) => number {
    const context = document.createElement("canvas").getContext("2d");
    const { fontFamily } = getComputedStyle(document.body);
    return (text, size) => {
        if (!context) return text.length * size * 0.6;
        context.font = `${size === TITLE_SIZE ? "600 " : ""}${size}px ${fontFamily}`;
        return context.measureText(text).width;
    };
}

const view = new View();
window.addEventListener("message", ({ data }: MessageEvent<ToView>) => {
    view.receive(data);
});
editor.postMessage({ type: "ready" });
