// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import type { Stage } from "./support/stage";
import { temporaryFolder } from "./support/workbench";

export function walkthrough(stage: Stage): void {
    stage.use();

    stage.test(
        "the walkthrough opens a sample with an error",
        () => temporaryFolder("empty"),
        async (window) => {
            const { page } = window;
            await window.runUntilAsked("Welcome: Open Walkthrough", "Model a robot with HL-SCXML");
            await window.answer("Model a robot with HL-SCXML", "Model a robot with HL-SCXML");
            const step = page.locator(".gettingStartedContainer");
            await step.getByText("Find an error and fix it").waitFor();
            await step.getByText("Open a sample system").click();
            await step.getByRole("button", { name: "Open Sample" }).waitFor();
            await window.screenshot("walkthrough");
            const open = step.getByRole("button", { name: "Open Sample" });
            await window.repeat(() => open.click(), window.question("Folder for the sample"));
            await window.answer("Folder for the sample");
            await page.locator('.tab[data-resource-name="battery.ascxml"]').waitFor();
            await window.squiggles.first().waitFor();
            assert.ok(fs.existsSync(path.join(window.folder, "delivery_robot/main.xml")));
        },
    );

    stage.test(
        "a new system has no errors, and CI is set up",
        () => {
            const folder = temporaryFolder("new");
            fs.writeFileSync(path.join(folder, "start.ascxml"), "<ascxml");
            return folder;
        },
        async (window) => {
            await window.openFile("start.ascxml");
            await window.running();
            await window.runUntilAsked("AS2FM: New System", "Folder of the new system");
            await window.answer("Folder of the new system");
            await window.page.locator('.tab.active[data-resource-name="main.xml"]').waitFor();
            await window.page.locator(".codelens-decoration", { hasText: "Translate to JANI" }).waitFor();
            await window.becomes(() => window.squiggles.count(), 0);
            await window.runUntilAsked("AS2FM: Add Check to CI", "GitHub");
            await window.answer("GitHub");
            await window.page.locator('.tab.active[data-resource-name="as2fm.yml"]').waitFor();
            const file = path.join(window.folder, ".github/workflows/as2fm.yml");
            assert.match(fs.readFileSync(file, "utf8"), /as2fm-lsp --check/);
        },
    );
}
