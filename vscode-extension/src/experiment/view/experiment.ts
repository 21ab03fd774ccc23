// SPDX-License-Identifier: Apache-2.0
/** The page with the plots and the table of an experiment. */

import type { ExperimentWords, FromExperiment, Live, Plot, ToExperiment } from "../contract";

declare function acquireVsCodeApi(): { postMessage(message: FromExperiment): void };

const SVG = "http://www.w3.org/2000/svg";
const editor = acquireVsCodeApi();
const bar = element("div", "bar");
const status = element("span", "status");
status.setAttribute("role", "status");
const content = element("div", "experiment");
const [answers, plots, hint, table, notes] = ["answers", "plots", "hint", "points", "notes-below"].map((name) =>
    element("div", name),
) as [HTMLElement, HTMLElement, HTMLElement, HTMLElement, HTMLElement];
content.append(answers, plots, hint, table, notes);
document.body.append(bar, content);

let words: ExperimentWords | undefined;
let isRunning = false;

window.addEventListener("message", ({ data }: MessageEvent<ToExperiment>) => {
    switch (data.type) {
        case "words":
            words = data.words;
            showBar();
            break;
        case "status":
            status.textContent = data.status;
            isRunning = data.isRunning;
            showBar();
            break;
        case "live":
            show(data.live);
            break;
    }
});
plots.addEventListener("click", ({ target }) => {
    const mark = target instanceof Element ? target.closest("[data-key]") : null;
    const key = mark?.getAttribute("data-key");
    if (key) editor.postMessage({ type: "run", key });
});
editor.postMessage({ type: "ready" });

function showBar(): void {
    if (!words) return;
    const buttons = isRunning
        ? [button(words.cancel, { type: "cancel" })]
        : [button(words.again, { type: "again" }), button(words.save, { type: "save" })];
    bar.replaceChildren(status, ...buttons);
}

function show(live: Live): void {
    answers.replaceChildren(...live.answers.map((text) => paragraph(sentence(text))));
    plots.replaceChildren(...live.plots.map(figure));
    hint.textContent = live.done > 0 && words ? words.hint : "";
    table.replaceChildren(tableOf(live));
    // The notes are below each plot already.
    notes.replaceChildren(...(live.plots.length > 0 ? [] : live.notes.map((text) => paragraph(sentence(text)))));
}

function figure(plot: Plot): Element {
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", [plot.x, plot.y, plot.width, plot.height].join(" "));
    svg.setAttribute("width", String(plot.width));
    svg.setAttribute("height", String(plot.height));
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-label", `${plot.title}. ${plot.description}`);
    svg.innerHTML = plot.scene;
    return svg;
}

/** The points; each is a button, so that keys reach what the marks of the plots do. */
function tableOf({ columns, rows }: Live): HTMLElement {
    const result = document.createElement("table");
    const head = result.createTHead().insertRow();
    for (const name of columns) {
        const cell = document.createElement("th");
        cell.scope = "col";
        cell.textContent = name;
        head.append(cell);
    }
    const body = result.createTBody();
    for (const { setting, points } of rows) {
        const row = body.insertRow();
        for (const value of Object.values(setting)) row.insertCell().textContent = value;
        for (const point of points) {
            const cell = row.insertCell();
            if (!point) continue;
            const run = button(point.text, { type: "run", key: point.key });
            if (words) run.title = words.run;
            cell.append(run);
        }
    }
    return result;
}

function sentence(text: string): string {
    return `${text}.`;
}

function paragraph(text: string): HTMLElement {
    const result = document.createElement("p");
    result.textContent = text;
    return result;
}

function button(text: string, message: FromExperiment): HTMLButtonElement {
    const result = document.createElement("button");
    result.textContent = text;
    result.addEventListener("click", () => {
        editor.postMessage(message);
    });
    return result;
}

function element(name: string, className: string): HTMLElement {
    const result = document.createElement(name);
    result.className = className;
    return result;
}
