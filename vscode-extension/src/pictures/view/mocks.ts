// SPDX-License-Identifier: Apache-2.0
/** Fields beside the picture of a tree, which set the mocks of its leaves. */

import type { FromView, MockField, MockFields, Words } from "../contract";

const MS_PER_S = 1000;

export class MockPane {
    readonly pane = document.createElement("div");
    private readonly result = document.createElement("output");
    private readonly verify = document.createElement("button");
    private readonly list = document.createElement("div");
    words: Words | undefined;
    /** Called with the ids of the leaves whose fields have the focus or the pointer; with none if no fields have. */
    onFocus: (nodes: readonly string[]) => void = () => undefined;

    constructor(private readonly send: (message: FromView) => void) {
        this.pane.className = "mocks";
        this.pane.hidden = true;
        this.list.className = "mock-list";
        this.result.setAttribute("aria-live", "polite");
        const head = document.createElement("div");
        head.className = "mock-head";
        head.append(this.result, this.verify);
        this.verify.addEventListener("click", () => {
            this.send({ type: "verify" });
        });
        this.pane.append(head, this.list);
    }

    get isOpen(): boolean {
        return !this.pane.hidden;
    }

    toggle(): void {
        this.pane.hidden = !this.pane.hidden;
    }

    /** Open the pane, and give its first field the focus. */
    focus(): void {
        this.pane.hidden = false;
        this.list.querySelector("input")?.focus();
    }

    /** Show the mocks; `opens` also opens the pane. */
    show(mocks: MockFields | null, busy: boolean, opens: boolean): void {
        if (mocks === null) this.pane.hidden = true;
        else if (opens) this.pane.hidden = false;
        const { words } = this;
        if (mocks === null || !words) return;
        this.pane.setAttribute("role", "form");
        this.pane.setAttribute("aria-label", words.mocks);
        this.verify.textContent = words.verify;
        this.result.textContent = busy ? words.verifying : mocks.problem || mocks.result || words.unverified;
        // While a field is used, its row is kept, so that the focus and the pointer are not lost.
        const active = document.activeElement;
        for (const [index, row] of mocks.rows.entries()) {
            const before = this.list.children[index];
            if (before?.contains(active) && before instanceof HTMLElement && before.dataset["pattern"] === row.pattern)
                before.querySelector(".mock-note")?.replaceChildren(noteOf(row));
            else if (before) before.replaceWith(this.row(row, words));
            else this.list.append(this.row(row, words));
        }
        while (this.list.children.length > mocks.rows.length) this.list.lastElementChild?.remove();
    }

    private row(field: MockField, words: Words): HTMLElement {
        const { pattern } = field;
        const row = document.createElement("div");
        row.className = "mock";
        row.dataset["pattern"] = pattern;
        row.setAttribute("role", "group");
        row.setAttribute("aria-label", pattern);
        const name = document.createElement("div");
        name.className = "mock-name";
        name.textContent = pattern;
        const note = document.createElement("div");
        note.className = "mock-note";
        note.textContent = noteOf(field);
        const slider = input("range", field.probability, `${pattern}, ${words.probability}`, 1, 0.01);
        const number = input("number", field.probability, `${pattern}, ${words.probability}`, 1, 0.01);
        const seconds =
            field.milliseconds === null
                ? undefined
                : input("number", field.milliseconds / MS_PER_S, `${pattern}, ${words.seconds}`, undefined, 0.1);
        const change = () => {
            const fields = seconds ? [number, seconds] : [number];
            if (!fields.every((one) => one.reportValidity() && one.value !== "")) return;
            const milliseconds = seconds ? Math.round(seconds.valueAsNumber * MS_PER_S) : null;
            this.send({ type: "setMock", pattern, probability: number.valueAsNumber, milliseconds });
        };
        slider.addEventListener("input", () => {
            number.value = slider.value;
        });
        number.addEventListener("input", () => {
            slider.value = number.value;
        });
        for (const one of [slider, number, seconds]) one?.addEventListener("change", change);
        const fields = document.createElement("div");
        fields.className = "mock-fields";
        fields.append(slider, number);
        if (seconds) {
            const unit = document.createElement("span");
            unit.textContent = "s";
            unit.setAttribute("aria-hidden", "true");
            fields.append(seconds, unit);
        }
        row.append(name, fields, note);
        const focus = () => {
            this.onFocus(field.nodes);
        };
        row.addEventListener("focusin", focus);
        row.addEventListener("pointerenter", focus);
        row.addEventListener("pointerleave", () => {
            this.onFocus([]);
        });
        row.addEventListener("focusout", () => {
            this.onFocus([]);
        });
        return row;
    }
}

function noteOf({ kind, origin, reason }: MockField): string {
    return origin === "" ? kind : `${kind}, ${origin}: ${reason}`;
}

function input(
    type: "range" | "number",
    value: number,
    label: string,
    max: number | undefined,
    step: number,
): HTMLInputElement {
    const made = document.createElement("input");
    made.type = type;
    made.min = "0";
    if (max !== undefined) made.max = String(max);
    // Any number may be typed; the arrow keys and the slider move by steps.
    made.step = type === "range" ? String(step) : "any";
    made.value = String(value);
    made.setAttribute("aria-label", label);
    return made;
}
