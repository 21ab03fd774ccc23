// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import type { Locator } from "playwright-core";
import { MEND, sample, type Stage } from "./support/stage";
import { write } from "./support/workbench";
import type { Window } from "./support/window";

/** The battery is empty after a second, which must not be. */
function failing(): string {
    const folder = sample({
        "nodes/battery.ascxml": (text) => MEND["nodes/battery.ascxml"](text).replace("level - 10", "level - 60"),
    });
    const expectations = { never_empty: ">= 0.95", all_delivered: ">= 0" };
    write(`${folder}/.vscode/settings.json`, JSON.stringify({ "as2fm.verify.expectations": expectations }));
    return folder;
}

export function verification(stage: Stage): void {
    stage.use();

    stage.test(
        "a lens verifies a property, and tells the result until a file changes",
        () => sample(MEND),
        async (window) => {
            await window.openFile("properties.jani");
            await window.running();
            await lens(window, "Verify").nth(1).click();
            await window.page
                .locator(".codelens-decoration a", { hasText: /Verify · 1 \[/ })
                .waitFor({ timeout: PATIENCE });
            await window.page
                .locator(".view-line", { hasText: /never_empty.*= 1 \[/ })
                .first()
                .waitFor();
            await window.screenshot("verified");
            await window.openFile("battery.ascxml");
            await window.goBehind("nodes/battery.ascxml", "Math.max(");
            await window.type(" ");
            await window.openFile("properties.jani");
            await window.page.locator(".codelens-decoration a", { hasText: "stale" }).waitFor();
        },
    );

    stage.test(
        "the Test Explorer: a property fails, and its counterexample leads to the models",
        failing,
        async (window) => {
            await window.openFile("main.xml");
            await window.running();
            await window.run("Testing: Focus on Test Explorer View");
            await row(window, "main.xml").waitFor();
            await window.openFile("battery.ascxml");
            await window.run("AS2FM: Show State Machine");
            const picture = await window.picture();
            await picture.locator('.node[data-label="driving"]').waitFor();
            await window.run("Test: Run All Tests");
            await row(window, "never_empty", "Failed").waitFor({ timeout: PATIENCE });
            await row(window, "all_delivered", "Passed").waitFor({ timeout: PATIENCE });
            await window.screenshot("test-explorer");
            await window.openFile("properties.jani");
            await window.page.locator(".codelens-decoration a", { hasText: "not ≥ 0.95" }).waitFor();
            await lens(window, "Show counterexample").click();
            const steps = window.page.locator(".pane", { hasText: "Counterexample" }).locator(".monaco-list-row");
            const step = steps.filter({ hasText: "Battery: " }).first();
            await step.waitFor();
            assert.ok((await steps.count()) > 1);
            await step.click();
            await window.page.locator('.tab.active[data-resource-name="battery.ascxml"]').waitFor();
            await picture.locator('.node.lit[data-label="driving"]').waitFor();
            await window.screenshot("counterexample");
        },
    );
}

/** A verification takes its time where no compiler has made the kernel fast. */
const PATIENCE = 120_000;

function lens(window: Window, title: string): Locator {
    return window.page.locator(".codelens-decoration a", { hasText: new RegExp(`^${title}$`) });
}

function row(window: Window, name: string, state = ""): Locator {
    return window.page
        .locator(`.test-explorer .monaco-list-row[aria-label*="${name}"][aria-label*="${state}"]`)
        .first();
}
