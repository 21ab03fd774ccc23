// SPDX-License-Identifier: Apache-2.0
import type { Locator } from "playwright-core";
import { MEND, sample, type Stage } from "./support/stage";
import type { Window } from "./support/window";

export function verification(stage: Stage): void {
    stage.use();

    stage.test(
        "a lens verifies a property and tells the result",
        () => sample(MEND),
        async (window) => {
            await window.openFile("properties.jani");
            await window.running();
            await lens(window, "Verify").nth(1).click();
            await window.page
                .locator(".codelens-decoration a", { hasText: /Verify · 1 \[/ })
                .waitFor({ timeout: PATIENCE });
            await window.page
                .locator(".view-line", { hasText: /never_empty.*=\s1\s\[/ })
                .first()
                .waitFor();
            await window.screenshot("verified");
        },
    );
}

/** A verification takes its time where no compiler has made the kernel fast. */
const PATIENCE = 120_000;

function lens(window: Window, title: string): Locator {
    return window.page.locator(".codelens-decoration a", { hasText: new RegExp(`^${title}$`) });
}
