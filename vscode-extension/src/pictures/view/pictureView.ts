// SPDX-License-Identifier: Apache-2.0
/** Draws the pictures that the extension sends, and sends the actions of the user to it. */

import {
    DIRECTIONS,
    type DrawnNode,
    type Drawing,
    type Coverage,
    type FromView,
    type Activity,
    type Box,
    WHOLE,
    type GraphPart,
    type MarkedParts,
    type Part,
    type Picture,
    type PictureEdge,
    type PictureFormat,
    type PictureNode,
    type ToView,
    type Words,
} from "../contract";
import {
    amongOthers,
    beside,
    bestDrawing,
    fit,
    fitLegibly,
    follow,
    fullest,
    isArrow,
    neighbour,
    OUTLINE,
    pan,
    reveal,
    search,
    shifts,
    trimsOf,
    withStart,
    zoom,
    type Frame,
    type PlacedNodes,
    type Sight,
} from "./find";
import { breakpointOf } from "../breakpoints";
import { filled, isOf, paint, shareOf, summaryOf } from "./coverage";
import { ExitChips } from "./exitChips";
import { NO_BANDS, SIDES, type Bands } from "./exits";
import { Minimap } from "./minimap";
import { MockPane } from "./mocks";
import { menuOf } from "./menu";
import { element, labelsOf, pngData, sceneOf, spoken, type Scene } from "./scene";
import { shownActivity, shownId } from "./shown";
import { legendOf, type LegendEntry } from "./words";
import { edgesOf, markEdges, type NodeEdges } from "./surroundings";
import { theme } from "./theme";

const ZOOM = 1.25;
/** The number of views of this page, whose elements have different ids. */
let views = 0;
/** The distance of the context menu from the corner of its node, in pixels. */
const MENU_OFFSET = 8;
/** How long a node whose look has changed is emphasised, in ms. */
const EMPHASIS_MS = 500;
/** How nodes move after a change of the text; the duration is in ms. */
const GLIDE = { duration: 180, easing: "ease-out" };
/** The maximum number of nodes of an animated drawing. */
const MAX_ANIMATED = 300;
/** The number of lines from which on those of the selected node, or of the node of the caret, stand out. */
const MANY_LINES = 12;

export class PictureView {
    private readonly svg = element("svg", { class: "picture", tabindex: 0, role: "application" });
    private readonly prefix = `picture${++views}`;
    /** What a screen reader says while another element than the picture has the focus. */
    private readonly said = document.createElement("div");
    private readonly bar = document.createElement("div");
    private readonly input = document.createElement("input");
    private readonly legend = document.createElement("div");
    private readonly notice = document.createElement("div");
    private readonly minimap = new Minimap((sight) => {
        this.moved = true;
        this.look(sight);
    });
    private readonly exits = new ExitChips(
        (node) => {
            this.moved = true;
            this.select(node);
            this.svg.focus();
        },
        (edges) => {
            this.pointed = edges.length > 0 ? { leaving: edges, entering: [] } : undefined;
            this.showSurroundings();
        },
    );
    /** The edges that the pointer emphasises: those of a node, or of a chip. */
    private pointed: NodeEdges | undefined;
    private readonly mocks = new MockPane((message) => {
        this.post(message);
    });
    private readonly mocksButton = document.createElement("button");
    private readonly partButton = document.createElement("button");
    private readonly coverageButton = document.createElement("button");
    private readonly outlineButton = document.createElement("button");
    /** Whether the user wants trees as outlines; undefined if the size of the window decides. */
    private wantsOutline: boolean | undefined;
    private showsCoverage = false;
    private coverage: Coverage | undefined;
    private part = WHOLE;
    private words: Words | undefined;
    private picture: Picture | undefined;
    /** The index of the drawing that is shown. */
    private shown = 0;
    /** Whether the user has changed the visible part, by scrolling or zooming. */
    private moved = false;
    /** What covers the picture at its sides, beside the chips and the map so that a first view cuts off nothing. */
    private bands = NO_BANDS;
    private trims = NO_BANDS;
    private scene: Scene | undefined;
    private sight: Sight = { x: 0, y: 0, scale: 1 };
    private selected = -1;
    /** The edge that is selected by the keyboard; -1 if it is a node. */
    private selectedEdge = -1;
    /** Is called with the id of the node that the user selects. */
    onSelect: (node: string) => void = () => undefined;
    private here: Part | null = null;
    private highlighted = "";
    private activity: Activity = { nodes: {}, edges: [] };
    private breakpoints: MarkedParts = { nodes: [], edges: [] };

    /**
     * `root` is the element that the view fills; keys are handled while the focus is in it. `least` is the smallest scale
     * in which a picture is shown first, if not the one in which it is legible.
     */
    constructor(
        private readonly root: HTMLElement,
        private readonly post: (message: FromView) => void,
        private readonly least?: number,
    ) {
        this.bar.className = "bar";
        this.legend.className = "legend";
        this.notice.className = "notice";
        this.notice.setAttribute("role", "status");
        this.said.className = "said";
        this.said.setAttribute("role", "status");
        const stage = document.createElement("div");
        stage.className = "stage";
        stage.append(this.svg, this.exits.layer, this.notice, this.minimap.svg);
        const middle = document.createElement("div");
        middle.className = "middle";
        middle.append(stage, this.mocks.pane);
        root.append(this.bar, middle, this.legend, this.said);
        this.mocks.onFocus = (nodes) => {
            this.emphasiseNodes(nodes);
        };
        this.listen();
        new ResizeObserver(() => {
            this.refit();
        }).observe(this.svg);
    }

    private get drawing(): Drawing | undefined {
        return this.picture?.drawings[this.shown];
    }

    receive(message: ToView): void {
        switch (message.type) {
            case "words":
                this.words = message.words;
                this.fillBar(message.words);
                break;
            case "show":
                this.show(message.picture, message.part, message.here, message.highlighted);
                break;
            case "here":
                this.mark(message.here);
                break;
            case "highlight":
                this.highlight(message.node);
                break;
            case "activity":
                this.showActivity(message.activity);
                break;
            case "breakpoints":
                this.breakpoints = message.parts;
                this.showBreakpoints();
                break;
            case "rasterize":
                void pngData(message.svg).then((data) => {
                    this.post({ type: "png", data });
                });
                break;
            case "mocks":
                this.mocks.show(message.mocks, message.busy, message.opens);
                this.mocksButton.hidden = message.mocks === null;
                this.showMocksState();
                break;
            case "coverage":
                this.receiveCoverage(message.coverage);
                break;
            case "none":
                this.clear();
                this.notice.textContent = message.reason;
                break;
        }
    }

    private show(picture: Picture, part: GraphPart, here: Part | null, highlighted: string): void {
        const isOther = this.picture?.title !== picture.title || this.picture.kind !== picture.kind;
        const isNew = isOther || part.matching !== this.part.matching || part.around !== this.part.around;
        this.part = part;
        const label = this.picture?.nodes[this.selected]?.label;
        const before = isNew ? undefined : this.placed;
        this.clear();
        this.picture = picture;
        // Beside all parts, the machine itself is meant.
        this.svg.dataset["vscodeContext"] = menuOf([], picture.kind === "machine" ? ["addState"] : []);
        this.here = here;
        this.highlighted = highlighted;
        if (isNew) {
            this.moved = false;
            this.shown = this.best();
        }
        this.draw();
        if (before) this.animateFrom(before);
        if (isNew) this.fitLegibly();
        this.mark(here);
        this.highlight(highlighted);
        this.offerPart();
        this.coverageButton.hidden = picture.kind === "ros";
        if (!isOther && label !== undefined) this.select(picture.nodes.findIndex((node) => node.label === label));
        this.post({ type: "drawn", nodes: picture.nodes.length, edges: picture.edges.length });
    }

    private get placed(): PlacedNodes | undefined {
        const { picture, drawing } = this;
        return picture && drawing && { nodes: drawing.nodes, ids: picture.nodes.map(({ id }) => id) };
    }

    /** Let the nodes glide from where they were before a change of the text. The lines appear where they are. */
    private animateFrom(before: PlacedNodes): void {
        const { placed, scene } = this;
        if (!placed || !scene || placed.nodes.length > MAX_ANIMATED || isMotionReduced()) return;
        const moved = shifts(before, placed);
        for (const { index, x, y } of moved)
            scene.nodes.get(index)?.animate([{ transform: `translate(${x}px, ${y}px)` }, {}], GLIDE);
        if (moved.length === 0) return;
        for (const part of scene.root.querySelectorAll(":scope > :is(.link, .edge, .label, .start)"))
            part.animate([{ opacity: 0 }, {}], GLIDE);
    }

    /** Draw the picture in the current direction. */
    private draw(): void {
        const { picture, drawing, words } = this;
        if (!picture || !drawing || !words) return;
        this.scene?.root.remove();
        this.scene = sceneOf(picture, drawing, words);
        this.svg.append(this.scene.root);
        this.minimap.show(picture, drawing);
        this.svg.setAttribute("aria-label", picture.title);
        this.svg.setAttribute("aria-description", words.help);
        for (const [index, group] of this.scene.nodes) group.id = `${this.prefix}-node${index}`;
        for (const [index, groups] of this.scene.edges) spoken(groups).id ||= `${this.prefix}-edge${index}`;
        this.exits.show(picture, drawing, this.scene);
        this.pointed = undefined;
        this.offerOutline();
        this.showCoverage(picture, drawing, words);
        this.look(this.sight, this.trims);
        this.showActivity(this.activity);
        this.showBreakpoints();
        if (this.input.value !== "") this.search();
    }

    private best(): number {
        const { width, height } = this.svg.getBoundingClientRect();
        const drawings = this.picture?.drawings ?? [];
        const outlines = drawings.slice(OUTLINE);
        if (this.wantsOutline === true && outlines.length > 0)
            return OUTLINE + bestDrawing(outlines, width, height, this.least);
        const candidates = this.wantsOutline === false ? drawings.slice(0, OUTLINE) : drawings;
        return bestDrawing(candidates, width, height, this.least);
    }

    private toggleOutline(): void {
        this.wantsOutline = this.shown < OUTLINE;
        this.shown = this.best();
        this.moved = false;
        this.drawAgain();
        this.fitLegibly();
        this.reveal(this.selected);
    }

    private offerOutline(): void {
        this.outlineButton.hidden = !this.picture?.drawings[OUTLINE];
        this.outlineButton.setAttribute("aria-pressed", String(this.shown >= OUTLINE));
    }

    /** Adapt the drawing to a new size of the window, unless the user has changed the visible part. */
    private refit(): void {
        if (this.moved || !this.picture) return;
        const best = this.best();
        if (best !== this.shown) {
            this.shown = best;
            this.drawAgain();
        }
        this.fitLegibly();
    }

    /** Draw the same picture, with the same marks. */
    private drawAgain(): void {
        this.draw();
        for (const group of this.parts(this.here)) group.classList.add("here");
        this.highlight(this.highlighted);
        this.scene?.nodes.get(this.selected)?.classList.add("selected");
        for (const group of this.scene?.edges.get(this.selectedEdge) ?? []) group.classList.add("selected");
        this.showSurroundings();
    }

    private clear(): void {
        this.scene?.root.remove();
        this.svg.removeAttribute("aria-activedescendant");
        this.scene = undefined;
        this.picture = undefined;
        this.selected = this.selectedEdge = -1;
        this.notice.textContent = "";
        this.legend.replaceChildren();
        this.minimap.clear();
        this.exits.clear();
    }

    // ------------------------------------------------------------------- looking

    /** Show a view. `trims` are the sizes by which it is smaller at its sides. */
    private look(sight: Sight, trims = NO_BANDS): void {
        this.sight = sight;
        this.trims = trims;
        const { x, y, scale } = sight;
        this.scene?.root.setAttribute("transform", `scale(${scale}) translate(${-x} ${-y})`);
        const { width, height } = this.svg.getBoundingClientRect();
        this.bands = sumOf(this.bandsAt(sight), trims);
        this.exits.look(sight, width, height, this.bands, this.minimap.size);
    }

    /** The bands at the sides of a view. */
    private bandsAt(sight: Sight): Bands {
        const { width, height } = this.svg.getBoundingClientRect();
        this.minimap.look(sight, width, height);
        return this.exits.bandsOf(sight, width, height, this.minimap.size);
    }

    /** Show the view that is chosen for the part of the window beside the bands. */
    private lookBeside(choose: (frame: Frame) => Sight): void {
        const { width, height } = this.svg.getBoundingClientRect();
        const { left, top } = this.bands;
        const chosen = pan(choose(beside(this.sight, width, height, this.bands)), -left, -top);
        if (chosen.x !== this.sight.x || chosen.y !== this.sight.y) this.look(chosen);
    }

    fit(): void {
        const { width, height } = this.svg.getBoundingClientRect();
        this.moved = true;
        if (this.drawing) this.look(fit(this.drawing, width, height));
    }

    private fitLegibly(): void {
        const { drawing } = this;
        if (!drawing) return;
        const { width, height } = this.svg.getBoundingClientRect();
        const boxes = this.innermost(drawing);
        const start = fitLegibly(drawing, width, height, this.least);
        let sight = start;
        let bands = this.bandsAt(start);
        // A view beside bands may show another part, which needs further bands. They only grow, up to those of all sides.
        for (let before: Bands = NO_BANDS; before !== bands;) {
            const frame = beside(start, width, height, bands);
            sight = pan(this.firstView(drawing, boxes, frame), -bands.left, -bands.top);
            before = bands;
            const needed = largerOf(bands, this.bandsAt(sight));
            if (SIDES.some((side) => needed[side] > before[side])) bands = needed;
        }
        const shown = beside(sight, width, height, this.bandsAt(sight));
        this.look(sight, trimsOf(drawing.nodes, this.labels, shown));
    }

    /** The first view of a drawing that does not fit into a window. */
    private firstView(drawing: Drawing, boxes: readonly Box[], { width, height }: Frame): Sight {
        const sight = fitLegibly(drawing, width, height, this.least);
        const first = this.firstBox(sight, width, height);
        if (first) return this.amongOthers(sight, drawing, first, width, height);
        return this.picture?.kind === "ros" ? fullest(sight, drawing, boxes, width, height) : sight;
    }

    /** The view that shows a node with as many others as possible, first of all those to which its edges lead. */
    private amongOthers(sight: Sight, drawing: Drawing, node: DrawnNode, width: number, height: number): Sight {
        const { picture } = this;
        const id = picture?.nodes[node.index]?.id;
        const targets = new Set(picture?.edges.filter(({ source }) => source === id).map(({ target }) => target));
        const others = this.innermost(drawing);
        const near = others.filter(({ index }) => targets.has(picture?.nodes[index]?.id ?? ""));
        return amongOthers(sight, drawing, node, near, others, width, height);
    }

    private get labels(): readonly Box[] {
        return this.scene ? labelsOf(this.scene) : [];
    }

    /** The nodes that contain no others. */
    private innermost(drawing: Drawing): readonly DrawnNode[] {
        const parents = new Set(this.picture?.nodes.map(({ parent }) => parent));
        return drawing.nodes.filter(({ index }) => !parents.has(this.picture?.nodes[index]?.id ?? ""));
    }

    /**
     * The node that is shown first: that of the caret, otherwise the initial state, otherwise the first node; -1 if it is
     * none in particular, in a ROS graph.
     */
    private get first(): number {
        const { here, picture } = this;
        if (here !== null) return this.nodeOf(here);
        if (picture?.kind === "ros") return picture.nodes.findIndex(({ id }) => id === this.part.around);
        const initial = picture?.nodes.findIndex((node) => node.initial && node.kind === "state") ?? -1;
        if (initial >= 0) return initial;
        return (this.drawing && this.innermost(this.drawing)[0]?.index) ?? -1;
    }

    /** The node of a part; that of a transition is its source. */
    private nodeOf(part: Part): number {
        if ("node" in part) return part.node;
        const source = this.picture?.edges[part.edge]?.source;
        return this.picture?.nodes.findIndex((node) => node.id === source) ?? -1;
    }

    /** The box of the node that is shown first, with what belongs to it: the dot of an initial state, and the frame
     * around it if the whole frame is visible. */
    private firstBox(sight: Sight, width: number, height: number): DrawnNode | undefined {
        const box = this.box(this.first);
        const node = this.picture?.nodes[this.first];
        if (!box || !node) return box;
        const frame = this.box(this.picture?.nodes.findIndex(({ id }) => id === node.parent) ?? -1);
        if (frame && frame.width * sight.scale <= width && frame.height * sight.scale <= height) return frame;
        return node.initial ? withStart(box) : box;
    }

    private box(node: number): DrawnNode | undefined {
        return this.drawing?.nodes.find(({ index }) => index === node);
    }

    /** Keep a node and the targets of its outgoing edges visible. */
    private keepInView(node: number): void {
        const { picture, drawing } = this;
        const box = this.box(node);
        if (!picture || !drawing || !box) return;
        const id = picture.nodes[node]?.id;
        const targets = new Set(picture.edges.filter(({ source }) => source === id).map(({ target }) => target));
        const others = drawing.nodes.filter(({ index }) => targets.has(picture.nodes[index]?.id ?? ""));
        this.lookBeside(({ sight, width, height }) => follow(sight, drawing, box, others, width, height));
        this.reveal(node);
    }

    private zoom(factor: number, about?: { x: number; y: number }): void {
        this.moved = true;
        const { width, height } = this.svg.getBoundingClientRect();
        this.look(zoom(this.sight, factor, about ?? { x: width / 2, y: height / 2 }));
    }

    /** Move the drawing so that a node is visible, and not below a band. */
    private reveal(node: number): void {
        const box = this.box(node);
        if (!box) return;
        this.lookBeside(({ sight, width, height }) => reveal(sight, box, width, height));
    }

    // ------------------------------------------------------------------ choosing

    /** Select a node; with `moves`, move the drawing so that it is visible. */
    private select(node: number, moves = true): void {
        this.selectEdge(-1);
        this.scene?.nodes.get(this.selected)?.classList.remove("selected");
        this.selected = node;
        this.onSelect(this.picture?.nodes[node]?.id ?? "");
        const chosen = this.scene?.nodes.get(node);
        chosen?.classList.add("selected");
        this.showSurroundings();
        if (!chosen) return;
        if (moves) this.reveal(node);
        this.notice.textContent = "";
        this.svg.setAttribute("aria-activedescendant", chosen.id);
    }

    /** Let the lines of the node with the pointer stand out, otherwise in large pictures those of the selected node or of
     * the caret. */
    private showSurroundings(): void {
        const { picture, scene, here, selected } = this;
        if (!picture || !scene || picture.kind === "tree") return;
        const hasMany = scene.root.querySelectorAll(":scope > :is(.link, .edge)").length >= MANY_LINES;
        const node = selected >= 0 || here === null ? selected : this.nodeOf(here);
        markEdges(scene, this.pointed ?? edgesOf(picture, hasMany ? node : -1));
    }

    private pointAt(target: EventTarget | null): void {
        const group = target instanceof Element ? target.closest<SVGGElement>("[data-node]") : null;
        const node = Number(group?.dataset["node"] ?? -1);
        this.pointed = this.picture && node >= 0 ? edgesOf(this.picture, node) : undefined;
        this.showSurroundings();
    }

    /** The element that handles the keys. */
    get focusable(): SVGElement {
        return this.svg;
    }

    /** Select an edge beside the node; -1 selects none. */
    private selectEdge(edge: number): void {
        for (const group of this.scene?.edges.get(this.selectedEdge) ?? []) group.classList.remove("selected");
        this.selectedEdge = edge;
        const groups = this.scene?.edges.get(edge) ?? [];
        for (const group of groups) group.classList.add("selected");
        if (groups.length > 0) this.svg.setAttribute("aria-activedescendant", spoken(groups).id);
        this.reveal(this.picture?.nodes.findIndex(({ id }) => id === this.picture?.edges[edge]?.target) ?? -1);
    }

    /** Select the next of the edges that leave the selected node, or the previous one. */
    private selectNextEdge(by: 1 | -1): void {
        const { picture, scene, selected } = this;
        const leaving = [...(scene?.edges.keys() ?? [])].filter(
            (edge) => picture?.edges[edge]?.source === picture?.nodes[selected]?.id,
        );
        const next = leaving.indexOf(this.selectedEdge) + by;
        this.selectEdge(leaving[next < 0 ? leaving.length - 1 : next] ?? leaving[0] ?? -1);
    }

    private get selectedPart(): Part {
        return this.selectedEdge >= 0 ? { edge: this.selectedEdge } : { node: this.selected };
    }

    /** Select the part that contains the caret. */
    private mark(here: Part | null): void {
        for (const group of this.parts(this.here)) group.classList.remove("here");
        this.here = here;
        for (const group of this.parts(here)) group.classList.add("here");
        this.showSurroundings();
        if (here === null || !this.picture) return;
        this.keepInView(this.nodeOf(here));
    }

    /** Highlight the node of the current step of a trace. */
    private highlight(id: string): void {
        this.highlighted = id;
        const { picture } = this;
        const shown = picture && id !== "" ? shownId(picture, id) : "";
        const highlighted = picture?.nodes.findIndex((node) => node.id === shown) ?? -1;
        for (const [index, node] of this.scene?.nodes ?? [])
            node.classList.toggle("highlighted", index === highlighted);
        if (highlighted >= 0) this.reveal(highlighted);
    }

    /** Mark the leaves of a mock. */
    private emphasiseNodes(ids: readonly string[]): void {
        const { picture } = this;
        for (const [index, node] of this.scene?.nodes ?? [])
            node.classList.toggle("mocked", ids.includes(picture?.nodes[index]?.id ?? ""));
        const first = picture?.nodes.findIndex(({ id }) => id === ids[0]) ?? -1;
        if (first >= 0) this.reveal(first);
    }

    private toggleCoverage(): void {
        this.showsCoverage = !this.showsCoverage;
        this.coverageButton.setAttribute("aria-pressed", String(this.showsCoverage));
        this.notice.textContent = "";
        this.coverage = undefined;
        this.post({ type: "coverage", shows: this.showsCoverage });
        if (!this.showsCoverage) this.drawAgain();
    }

    private receiveCoverage(coverage: Coverage | null): void {
        const { words } = this;
        if (!words || !this.showsCoverage) return;
        const before = this.coverage;
        this.coverage = coverage && !coverage.isStale ? coverage : undefined;
        if (coverage === null) this.notice.textContent = words.coverage.notVerified;
        else this.notice.textContent = coverage.isStale ? words.coverage.stale : "";
        if (JSON.stringify(before) !== JSON.stringify(this.coverage)) this.drawAgain();
    }

    /** Paint the coverage, if it is shown, and fill the legend. */
    private showCoverage(picture: Picture, drawing: Drawing, words: Words): void {
        this.legend.replaceChildren(...legendOf(picture, words).map(entry));
        const { coverage, scene } = this;
        if (!coverage || !scene || !isOf(coverage, picture)) return;
        paint(scene, drawing, coverage, words.coverage);
        this.legend.append(...coverageLegend(coverage, words));
    }

    private showMocksState(): void {
        this.mocksButton.setAttribute("aria-expanded", String(this.mocks.isOpen));
    }

    /** Show where a run is: active states, statuses of nodes, messages. */
    private showActivity(activity: Activity): void {
        const { picture, scene } = this;
        const earlier = this.activity;
        this.activity = activity;
        if (!picture || !scene) return;
        const [before, now] = [shownActivity(picture, earlier), shownActivity(picture, activity)];
        for (const [index, group] of scene.nodes) {
            const id = picture.nodes[index]?.id ?? "";
            const look = now.nodes[id];
            if (look === undefined) delete group.dataset["look"];
            else group.dataset["look"] = look;
            if (look !== undefined && look !== "idle" && look !== before.nodes[id]) emphasise(group);
        }
        for (const [index, groups] of scene.edges) {
            const edge = picture.edges[index];
            const isActive = now.edges.some(({ from, to }) => from === edge?.source && to === edge.target);
            for (const group of groups) group.classList.toggle("active", isActive);
        }
        this.describeNodes();
        this.revealActivity(picture, now);
    }

    /** Tell screen readers what the look of a node means, and whether it has a breakpoint. */
    private describeNodes(): void {
        const { words, scene, breakpoints } = this;
        if (!words || !scene) return;
        for (const [index, group] of scene.nodes) {
            const look = words.looks[group.dataset["look"] ?? ""] ?? "";
            const texts = [look, breakpoints.nodes.includes(index) ? words.breakpoint : ""];
            const text = texts.filter((text) => text !== "").join(", ");
            if (text === "") group.removeAttribute("aria-description");
            else group.setAttribute("aria-description", text);
        }
    }

    /** Show the node that is next; otherwise the innermost node that is running, or the ends of an active edge. */
    private revealActivity(picture: Picture, activity: Activity): void {
        const lookOf = ({ id }: PictureNode) => activity.nodes[id] ?? "";
        const next = picture.nodes.findIndex((node) => ["next", "message"].includes(lookOf(node)));
        // Children follow their parents.
        const running = picture.nodes.findLastIndex((node) => ["running", "ticked"].includes(lookOf(node)));
        if (next >= 0 || running >= 0) {
            this.keepInView(next >= 0 ? next : running);
            return;
        }
        for (const id of activity.edges.slice(0, 1).flatMap(({ from, to }) => [to, from]))
            this.reveal(picture.nodes.findIndex((node) => node.id === id));
    }

    /** Put a dot on the parts that have a breakpoint. */
    private showBreakpoints(): void {
        const { scene, breakpoints } = this;
        this.describeNodes();
        for (const dot of scene?.root.querySelectorAll(".breakpoint") ?? []) dot.remove();
        for (const node of breakpoints.nodes) {
            const box = this.box(node);
            if (box) scene?.root.append(element("circle", { class: "breakpoint", cx: box.x, cy: box.y, r: 6 }));
        }
        for (const edge of breakpoints.edges) {
            for (const group of scene?.edges.get(edge) ?? []) {
                const line = group.querySelector<SVGPathElement>(".line");
                if (!line) continue;
                const { x, y } = line.getPointAtLength(line.getTotalLength() / 2);
                scene?.root.append(element("circle", { class: "breakpoint", cx: x, cy: y, r: 5 }));
            }
        }
    }

    /** Set or remove the breakpoint of a part; return whether it can have one. */
    private toggleBreakpoint(part: Part): boolean {
        const breakpoint = this.picture && breakpointOf(this.picture, part);
        if (breakpoint) this.post({ type: "breakpoint", breakpoint });
        return breakpoint !== undefined;
    }

    private parts(part: Part | null): readonly SVGGElement[] {
        if (part === null || !this.scene) return [];
        if ("edge" in part) return this.scene.edges.get(part.edge) ?? [];
        const node = this.scene.nodes.get(part.node);
        return node ? [node] : [];
    }

    private jump(to: PictureNode | PictureEdge | undefined, beside: boolean): void {
        if (to?.place) this.post({ type: "jump", place: to.place, beside });
    }

    /** Hide the nodes below a node of a tree, or in a group or namespace, or show them again; return whether it has such. */
    private collapse(node: number): boolean {
        const { id, kind } = this.picture?.nodes[node] ?? {};
        if (id === undefined || (this.picture?.kind !== "tree" && kind !== "namespace" && kind !== "group"))
            return false;
        this.post({ type: "collapse", node: id });
        return true;
    }

    /** Show only a node of a ROS graph and its neighbours, or all nodes again. */
    private surround(node: number): void {
        const id = this.picture?.nodes[node]?.id;
        if (this.picture?.kind !== "ros" || id === undefined) return;
        this.post({ type: "part", part: this.part.around === "" ? { ...this.part, around: id } : WHOLE });
    }

    /** Show only the results of the search in a ROS graph, or all nodes again. */
    private togglePart(): void {
        const matching = this.input.value.trim();
        this.post({ type: "part", part: this.isPart ? WHOLE : { ...WHOLE, matching } });
    }

    private get isPart(): boolean {
        return this.part.matching !== "" || this.part.around !== "";
    }

    private offerPart(): void {
        const { words, partButton } = this;
        if (!words) return;
        partButton.textContent = partButton.title = this.isPart ? words.showAll : words.onlyResults;
        partButton.hidden = this.picture?.kind !== "ros" || !(this.isPart || this.input.value.trim() !== "");
    }

    /** Open the context menu of the selected node, or that of the picture. VS Code listens to this event. */
    private openMenu(): void {
        const group = this.parts(this.selectedPart)[0] ?? this.svg;
        const { left, top } = group.getBoundingClientRect();
        const place = { clientX: left + MENU_OFFSET, clientY: top + MENU_OFFSET };
        group.dispatchEvent(new MouseEvent("contextmenu", { bubbles: true, cancelable: true, ...place }));
    }

    /** Show the nodes that contain the words of a text. */
    find(text: string): void {
        this.input.value = text;
        this.search();
    }

    private search(forward = false): void {
        this.offerPart();
        if (!this.picture || !this.scene) return;
        const matches = search(this.picture, this.input.value);
        this.minimap.mark(matches);
        this.scene.root.classList.toggle("searched", this.input.value.trim() !== "");
        for (const [index, node] of this.scene.nodes) node.classList.toggle("found", matches.includes(index));
        this.notice.textContent =
            this.input.value.trim() !== "" && matches.length === 0 ? (this.words?.nothing ?? "") : "";
        const next = forward ? matches.find((index) => index > this.selected) : undefined;
        const first = next ?? matches[0];
        if (first !== undefined) this.select(first);
        this.said.textContent = first === undefined ? "" : this.describeMatch(matches, first);
    }

    /** The node that a search has selected, and its number among the matches. */
    private describeMatch(matches: readonly number[], node: number): string {
        const label = this.scene?.nodes.get(node)?.getAttribute("aria-label") ?? "";
        const text = this.words?.match ?? "";
        return filled(text, label, matches.indexOf(node) + 1, matches.length);
    }

    // ------------------------------------------------------------------- the user

    private listen(): void {
        this.svg.addEventListener("click", ({ target, ctrlKey, metaKey, altKey }) => {
            if (!(target instanceof Element) || !this.scene || !this.picture) return;
            const { node, edges } = target.closest<SVGGElement>("[data-node], [data-edges]")?.dataset ?? {};
            if (altKey && (node ?? edges) !== undefined) {
                this.toggleBreakpoint(node ? { node: Number(node) } : { edge: Number(edges?.split(" ")[0]) });
                return;
            }
            if (node !== undefined) {
                // It stays below the pointer, so that a second click is a double click.
                this.select(Number(node), false);
                this.jump(this.picture.nodes[Number(node)], ctrlKey || metaKey);
            } else if (edges !== undefined) {
                this.jump(this.picture.edges[Number(edges.split(" ")[0])], ctrlKey || metaKey);
            }
        });
        // The selected node is shown again after its action, even if the picture has grown.
        this.svg.addEventListener("contextmenu", ({ target }) => {
            const node = target instanceof Element && target.closest<SVGGElement>("[data-node]")?.dataset["node"];
            if (node) this.select(Number(node));
        });
        this.svg.addEventListener("pointerover", ({ target }) => {
            this.pointAt(target);
        });
        this.svg.addEventListener("pointerleave", () => {
            this.pointAt(null);
        });
        this.svg.addEventListener("dblclick", ({ target }) => {
            const node = target instanceof Element && target.closest<SVGGElement>("[data-node]")?.dataset["node"];
            if (target === this.svg) this.fit();
            else if (node) this.collapse(Number(node));
        });
        this.svg.addEventListener(
            "wheel",
            (event) => {
                event.preventDefault();
                if (!event.ctrlKey && !event.metaKey) {
                    this.moved = true;
                    const [dx, dy] = event.shiftKey ? [event.deltaY, event.deltaX] : [event.deltaX, event.deltaY];
                    this.look(pan(this.sight, dx, dy));
                    return;
                }
                const { left, top } = this.svg.getBoundingClientRect();
                const about = { x: event.clientX - left, y: event.clientY - top };
                this.zoom(Math.exp(-event.deltaY / 200), about);
            },
            { passive: false },
        );
        this.svg.addEventListener("pointerdown", (event) => {
            if (
                event.button !== 0 ||
                (event.target instanceof Element && event.target.closest("[data-node], [data-edges]"))
            )
                return;
            this.svg.setPointerCapture(event.pointerId);
            this.svg.classList.add("moving");
        });
        this.svg.addEventListener("pointermove", (event) => {
            if (!this.svg.hasPointerCapture(event.pointerId)) return;
            this.moved = true;
            this.look(pan(this.sight, -event.movementX, -event.movementY));
        });
        const release = () => {
            this.svg.classList.remove("moving");
        };
        this.svg.addEventListener("pointerup", release);
        this.svg.addEventListener("pointercancel", release);
        this.root.addEventListener("keydown", (event) => {
            if (this.key(event)) event.preventDefault();
        });
        this.input.addEventListener("input", () => {
            this.search();
        });
    }

    /** Handle a key; return whether the view uses it. */
    private key({ key, ctrlKey, metaKey, shiftKey }: KeyboardEvent): boolean {
        if (this.mocks.pane.contains(document.activeElement)) {
            if (key !== "Escape") return false;
            this.svg.focus();
            return true;
        }
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
        // They press the button that has the focus.
        const isOnButton = [this.bar, this.exits.layer].some((part) => part.contains(document.activeElement));
        if ((key === "Enter" || key === " ") && isOnButton) return false;
        if (ctrlKey || metaKey) {
            const change = { z: shiftKey ? "redo" : "undo", y: "redo" } as const;
            if (key.toLowerCase() in change) {
                this.post({ type: change[key.toLowerCase() as keyof typeof change] });
                return true;
            }
        }
        if (key === "/" || (key === "f" && (ctrlKey || metaKey))) this.input.focus();
        else if (ctrlKey || metaKey) return false;
        else if (isArrow(key)) this.select(neighbour(this.drawing?.nodes ?? [], this.selected, key) ?? this.selected);
        else if (key === "ContextMenu" || (key === "F10" && shiftKey)) this.openMenu();
        else if (key === "Enter")
            this.jump(this.picture?.edges[this.selectedEdge] ?? this.picture?.nodes[this.selected], false);
        else if (key === "b") this.toggleBreakpoint(this.selectedPart);
        else if (key === "m" && !this.mocksButton.hidden) {
            this.mocks.focus();
            this.showMocksState();
        } else if (key === "t" || key === "T") this.selectNextEdge(shiftKey ? -1 : 1);
        else if (key === " ") {
            if (!this.collapse(this.selected)) this.surround(this.selected);
        } else if (key === "+" || key === "=") this.zoom(ZOOM);
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
        this.mocks.words = words;
        const { mocksButton } = this;
        mocksButton.textContent = words.mocks;
        mocksButton.title = words.mocks;
        mocksButton.hidden = true;
        mocksButton.addEventListener("click", () => {
            this.mocks.toggle();
            this.showMocksState();
        });
        this.offerPart();
        this.partButton.addEventListener("click", () => {
            this.togglePart();
        });
        const { coverageButton } = this;
        coverageButton.textContent = words.coverage.show;
        coverageButton.title = words.coverage.hint;
        coverageButton.setAttribute("aria-pressed", String(this.showsCoverage));
        coverageButton.addEventListener("click", () => {
            this.toggleCoverage();
        });
        const { outlineButton } = this;
        outlineButton.textContent = words.outline;
        outlineButton.title = words.outlineHint;
        outlineButton.addEventListener("click", () => {
            this.toggleOutline();
        });
        this.offerOutline();
        this.bar.replaceChildren(
            this.input,
            this.partButton,
            outlineButton,
            mocksButton,
            coverageButton,
            button("+", words.zoomIn, () => {
                this.zoom(ZOOM);
            }),
            button("−", words.zoomOut, () => {
                this.zoom(1 / ZOOM);
            }),
            button(words.fit, words.fit, () => {
                this.fit();
            }),
            button("SVG", words.saveSvg, () => {
                this.save("svg");
            }),
            button("PNG", words.savePng, () => {
                this.save("png");
            }),
            button("PDF", words.savePdf, () => {
                this.save("pdf");
            }),
        );
    }

    private save(format: PictureFormat): void {
        const direction = DIRECTIONS[this.shown];
        if (this.picture && direction) this.post({ type: "save", format, direction, theme: theme() });
    }
}

function sumOf(one: Bands, other: Bands): Bands {
    return {
        top: one.top + other.top,
        bottom: one.bottom + other.bottom,
        left: one.left + other.left,
        right: one.right + other.right,
    };
}

function largerOf(one: Bands, other: Bands): Bands {
    return {
        top: Math.max(one.top, other.top),
        bottom: Math.max(one.bottom, other.bottom),
        left: Math.max(one.left, other.left),
        right: Math.max(one.right, other.right),
    };
}

/** Draw the outline of a node thick for a moment, because its look has changed. */
function emphasise(group: SVGGElement): void {
    if (!isMotionReduced()) group.querySelector(":scope > .card")?.animate([{ strokeWidth: "12px" }, {}], EMPHASIS_MS);
}

function isMotionReduced(): boolean {
    return (
        document.body.classList.contains("vscode-reduce-motion") ||
        window.matchMedia("(prefers-reduced-motion: reduce)").matches
    );
}

/** What was read, and the shares of traces that occur in the picture. */
function coverageLegend(coverage: Coverage, { coverage: words }: Words): HTMLElement[] {
    const counts = [...coverage.nodes.map((node) => node?.traces), ...coverage.edges];
    const shares = new Set(
        counts.flatMap((traces) => (typeof traces === "number" ? shareOf(traces, coverage.traces) : [])),
    );
    const texts = { all: words.inAll, some: words.inSome, none: words.inNone };
    const heading = document.createElement("span");
    heading.className = "cover-summary";
    heading.textContent = `${summaryOf(coverage, words)}:`;
    const entries = (["all", "some", "none"] as const)
        .filter((share) => shares.has(share))
        .map((share) => {
            const made = document.createElement("span");
            const sample = element("svg", { width: 24, height: 10, class: "scene", "aria-hidden": "true" });
            const group = element("g", { "data-cover": share });
            group.append(element("rect", { x: 1, y: 1, width: 22, height: 8, rx: 2, class: "card" }));
            sample.append(group);
            made.append(sample, texts[share]);
            return made;
        });
    return [heading, ...entries];
}

function entry({ tone, text, isLine, kind, symbol }: LegendEntry): HTMLElement {
    const made = document.createElement("span");
    const width = isLine ? 24 : symbol === "double" ? 18 : 10;
    const sample = element("svg", { width, height: 10, class: "scene", "aria-hidden": "true" });
    const group = element("g", { class: `link tone-${tone} is-${kind}` });
    group.append(...(isLine ? [element("path", { d: "M 1 5 H 23", class: "line" })] : symbolOf(symbol)));
    sample.append(group);
    made.append(sample, text);
    return made;
}

/** A symbol of 10 x 10 pixels, or of 18 x 10 for the border of a state; a colored square by default. */
function symbolOf(symbol: LegendEntry["symbol"]): SVGElement[] {
    switch (symbol) {
        case "dot":
            return [element("circle", { cx: 5, cy: 5, r: 4, class: "dot" })];
        case "bar":
            return [element("rect", { x: 4, y: 0, width: 3, height: 10, rx: 1.5, class: "bar" })];
        case "double":
            return [
                element("rect", { x: 0.5, y: 0.5, width: 17, height: 9, rx: 2, class: "legend-border" }),
                element("rect", { x: 2.5, y: 2.5, width: 13, height: 5, rx: 1, class: "legend-border" }),
            ];
        case undefined:
            return [element("rect", { x: 0, y: 0, width: 10, height: 10, rx: 2, class: "badge" })];
    }
}
