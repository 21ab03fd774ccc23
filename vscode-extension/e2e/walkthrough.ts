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
            await window.run("Welcome: Open Walkthrough");
            await page.locator(".quick-input-widget input").fill("Model a robot");
            await page.locator(".quick-input-list", { hasText: "Model a robot with HL-SCXML" }).waitFor();
            await window.press("Enter");
            const step = page.locator(".gettingStartedContainer");
            await step.getByText("Find an error and fix it").waitFor();
            await step.getByText("Open a sample system").click();
            await step.getByRole("button", { name: "Open Sample" }).waitFor();
            await window.screenshot("walkthrough");
            await step.getByRole("button", { name: "Open Sample" }).click();
            await page.locator(".quick-input-widget", { hasText: "Folder for the sample" }).waitFor();
            await window.press("Enter");
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
            await window.run("AS2FM: New System");
            await window.page.locator(".quick-input-widget", { hasText: "Folder of the new system" }).waitFor();
            await window.press("Enter");
            await window.page.locator('.tab.active[data-resource-name="main.xml"]').waitFor();
            await window.page.locator(".codelens-decoration", { hasText: "Translate to JANI" }).waitFor();
            assert.equal(await window.squiggles.count(), 0);
            await window.run("AS2FM: Add Check to CI");
            await window.page.locator(".quick-input-list", { hasText: "GitHub" }).waitFor();
            await window.press("Enter");
            await window.page.locator('.tab.active[data-resource-name="as2fm.yml"]').waitFor();
            const file = path.join(window.folder, ".github/workflows/as2fm.yml");
            assert.match(fs.readFileSync(file, "utf8"), /as2fm-lsp --check/);
        },
    );
}
