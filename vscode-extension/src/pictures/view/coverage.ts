// SPDX-License-Identifier: Apache-2.0
/** What the traces of a verification have executed, painted on the parts of a picture. */

import type { Coverage, CoverageWords, CoveredNode, Drawing, Picture } from "../contract";
import { element, type Scene } from "./scene";

/** How many of the traces have executed a part. */
export type Share = "all" | "some" | "none";

export function shareOf(traces: number, all: number): Share {
    if (traces === 0) return "none";
    return traces < all ? "some" : "all";
}

/** The description of a part for screen readers and for hovers. */
export function coverageWords(traces: number, all: number, words: CoverageWords): string {
    switch (shareOf(traces, all)) {
        case "all":
            return filled(words.all, all);
        case "some":
            return filled(words.some, traces, all);
        case "none":
            return filled(words.none, all);
    }
}

/** The description of a node, with the statuses that it has returned in some of the traces. */
export function nodeCoverageWords({ traces, statuses }: CoveredNode, all: number, words: CoverageWords): string {
    const returned = Object.entries(statuses).map(
        ([status, count]) => `${filled(words.returned, status)} ${coverageWords(count, all, words)}`,
    );
    return [coverageWords(traces, all, words), ...returned].join(", ");
}

/** A short form for the picture; "" if all traces have executed the part. */
export function badgeOf(traces: number, all: number, words: CoverageWords): string {
    if (traces === 0) return words.never;
    if (traces === all) return "";
    const percent = (100 * traces) / all;
    if (percent < 1) return "< 1 %";
    return percent > 99 ? "> 99 %" : `${Math.round(percent)} %`;
}

/** Which traces of which system were read. */
export function summaryOf({ traces, simulated, system }: Coverage, words: CoverageWords): string {
    return filled(words.part, traces, simulated, decodeURIComponent(system.replace(/^.*\//, "")));
}

/** Whether a coverage belongs to a picture, which may have changed since it was asked for. */
export function isOf(coverage: Coverage, picture: Picture): boolean {
    const { nodes, edges } = coverage;
    return nodes.length === picture.nodes.length && edges.length === picture.edges.length;
}

/** Paint a coverage on the elements of a drawing that has no other one. */
export function paint(scene: Scene, drawing: Drawing, coverage: Coverage, words: CoverageWords): void {
    const all = coverage.traces;
    for (const { index, x, y, width } of drawing.nodes) {
        const [group, covered] = [scene.nodes.get(index), coverage.nodes[index]];
        if (!group || !covered) continue;
        group.dataset["cover"] = shareOf(covered.traces, all);
        describe(group, nodeCoverageWords(covered, all, words));
        if (group.querySelector(":scope > .card")) addBadge(group, x + width, y, badgeOf(covered.traces, all, words));
    }
    for (const group of new Set([...scene.edges.values()].flat())) {
        const indexes = (group.dataset["edges"] ?? "").split(" ").map(Number);
        const counts = indexes.flatMap((index) => coverage.edges[index] ?? []);
        if (counts.length === 0) continue;
        // A line that several transitions share was taken if one of them was.
        const traces = Math.max(...counts);
        group.dataset["cover"] = shareOf(traces, all);
        describe(group, counts.map((count) => coverageWords(count, all, words)).join("; "));
        // The text of a transition is a row in the card of a state or of a label.
        const row = group.querySelector<SVGTextElement>(":scope > text");
        const card = group.parentElement?.querySelector<SVGRectElement>(":scope > :is(.card, .label-card)");
        if (row && card) {
            const right = card.x.baseVal.value + card.width.baseVal.value;
            addBadge(group, right, (row.y.baseVal[0]?.value ?? 0) - 4, badgeOf(traces, all, words));
        }
    }
}

/** Add the coverage to the name and to the hover of a part. */
function describe(group: SVGGElement, text: string): void {
    group.setAttribute("aria-label", [group.getAttribute("aria-label"), text].filter(Boolean).join(", "));
    let title = group.querySelector(":scope > title");
    if (!title) {
        title = element("title", {});
        group.prepend(title);
    }
    title.textContent = [title.textContent, text].filter((line) => line !== "").join("\n");
}

/** The distance between the text of a badge and its border, in pixels. */
const PADDING = 4;
const CHARACTER = 6.6;
const HEIGHT = 15;

/** Add a badge to a group, whose middle is a point; none if its text is empty. */
function addBadge(group: SVGGElement, x: number, y: number, text: string): void {
    if (text === "") return;
    const badge = element("g", { class: "cover-badge", "aria-hidden": "true" });
    const width = text.length * CHARACTER + 2 * PADDING;
    const frame = { x: x - width / 2, y: y - HEIGHT / 2, width, height: HEIGHT, rx: HEIGHT / 2 };
    const label = element("text", { x, y: y + 4, "text-anchor": "middle", "font-size": 11 });
    label.textContent = text;
    badge.append(element("rect", frame), label);
    group.append(badge);
}

/** A text whose places `{0}`, `{1}`, … contain values. */
export function filled(text: string, ...values: readonly (string | number)[]): string {
    return text.replace(/\{(\d)\}/g, (_, index: string) => {
        const value = values[Number(index)] ?? "";
        return typeof value === "number" ? value.toLocaleString() : value;
    });
}
