// SPDX-License-Identifier: Apache-2.0
/** The menu that chooses the curves which are drawn over each other. */

import type { TimelineWords } from "../contract";

export class CurvesMenu {
    readonly menu = document.createElement("details");
    private readonly title = document.createElement("summary");
    private readonly list = document.createElement("div");
    private readonly chosen = new Set<string>();
    private offered: readonly string[] = [];
    private nothing = "";

    constructor(private readonly choose: (curves: readonly string[]) => void) {
        this.menu.className = "curves";
        this.list.className = "curve-list";
        this.menu.append(this.title, this.list);
        this.menu.addEventListener("keydown", (event) => {
            if (event.key !== "Escape") return;
            this.menu.open = false;
            this.title.focus();
        });
        document.addEventListener("pointerdown", ({ target }) => {
            if (target instanceof Node && !this.menu.contains(target)) this.menu.open = false;
        });
    }

    name(words: TimelineWords): void {
        this.title.textContent = words.curves;
        this.nothing = words.noCurves;
        this.fill();
    }

    /** Offer the curves of the run. */
    offer(names: readonly string[]): void {
        if (names.join("\n") === this.offered.join("\n")) return;
        this.offered = names;
        this.fill();
    }

    private fill(): void {
        if (this.offered.length === 0) this.list.textContent = this.nothing;
        else this.list.replaceChildren(...this.offered.map((name) => this.entry(name)));
    }

    private entry(name: string): HTMLElement {
        const entry = document.createElement("label");
        const box = document.createElement("input");
        box.type = "checkbox";
        box.checked = this.chosen.has(name);
        box.addEventListener("change", () => {
            if (box.checked) this.chosen.add(name);
            else this.chosen.delete(name);
            this.choose([...this.chosen]);
        });
        entry.append(box, name);
        return entry;
    }
}
