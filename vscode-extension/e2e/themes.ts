// SPDX-License-Identifier: Apache-2.0
/**
 * The pictures of the walkthrough. `npm run e2e -- --pictures` takes them in each kind of theme; otherwise only a theme
 * with high contrast is tested, because all other tests use a light one.
 */

import * as path from "node:path";
import { MEND, sample, type Stage } from "./support/stage";
import { themes } from "./support/themes";
import { write } from "./support/workbench";

export function walkthroughPictures(stage: Stage): void {
    stage.use();

    for (const [theme, name] of themes("hc-dark", "light", "dark", "hc-light", "hc-dark")) {
        const settings = JSON.stringify({
            "workbench.colorTheme": name,
            "workbench.secondarySideBar.defaultVisibility": "hidden",
            "as2fm.verify.epsilon": 0.05,
            "as2fm.verify.expectations": { never_empty: ">= 0.9" },
        });
        const broken = () => {
            const folder = sample();
            write(path.join(folder, ".vscode/settings.json"), settings);
            return folder;
        };
        const sound = () => {
            const folder = sample({ ...MEND, "tree.xml": (text) => text.replace('level="30"', 'level="0"') });
            write(path.join(folder, ".vscode/settings.json"), settings);
            return folder;
        };

        stage.test(`the walkthrough's pictures of an error, ${theme}`, broken, async (window) => {
            const { page } = window;
            await window.openFile("battery.ascxml");
            await window.running();
            await window.squiggles.first().waitFor();
            await window.screenshot(`server-${theme}`, { x: 640, y: 560, width: 640, height: 200 });
            await window.screenshot(`open-${theme}`, { x: 0, y: 35, width: 800, height: 500 });
            await window.goBehind("nodes/battery.ascxml", 'location="levl');
            const clip = { x: 348, y: 260, width: 800, height: 500 };
            await window.quickFix("level", () => window.screenshot(`fix-${theme}`, clip));
            await window.squiggles.first().waitFor({ state: "detached" });
            await window.runUntilAsked("AS2FM: Add Check to CI", "GitHub");
            await window.answer("GitHub");
            await page.locator('.tab.active[data-resource-name="as2fm.yml"]').waitFor();
            await window.editor.locator(".view-line", { hasText: "as2fm-lsp" }).first().waitFor();
            await window.screenshot(`ci-${theme}`, { x: 348, y: 35, width: 800, height: 500 });
        });

        stage.test(`the walkthrough's pictures of a system, ${theme}`, sound, async (window) => {
            const { page } = window;
            await window.openFile("main.xml");
            await window.running();
            await window.run("AS2FM: Show ROS Graph");
            const picture = await window.picture();
            await picture.locator('.node[data-label="/hand_over"]').waitFor();
            await page.locator(".codelens-decoration a", { hasText: "Translate to JANI" }).waitFor();
            await window.screenshot(`graph-${theme}`, { x: 480, y: 35, width: 800, height: 700 });
            await page.locator(".tab", { hasText: "ROS Graph" }).locator(".codicon-close").click();
            await window.openFile("main.xml");
            await window.run("AS2FM: Translate to JANI");
            await page.locator('.tab[data-resource-name="main (laid out).jani"]').waitFor();
            await page.locator(".view-line", { hasText: '"jani-version"' }).waitFor();
            await window.notified("Wrote main.jani");
            await window.run("Notifications: Clear All Notifications");
            await window.clickTab("main (laid out).jani");
            await window.run("Explorer: Focus on Outline View");
            const outline = page.locator(".pane", { has: page.locator(".outline-pane") });
            await outline.locator(".monaco-list-row", { hasText: "topic_battery_msg.valid" }).waitFor();
            await outline.locator(".pane-header").getByRole("button", { name: "Collapse All" }).click();
            await outline.locator(".monaco-list-row", { hasText: "automata" }).waitFor();
            // The hover of the tab would cover the text.
            await page.mouse.move(640, 400);
            await page.locator(".workbench-hover").first().waitFor({ state: "detached" });
            await window.screenshot(`translate-${theme}`, { x: 0, y: 35, width: 1280, height: 700 });
            await page.locator('.tab[data-resource-name="main (laid out).jani"] .codicon-close').click();
            await window.openFile("properties.xml");
            await window.run("AS2FM: Verify");
            const row = page.locator(".test-explorer-tree .monaco-list-row", { hasText: "never_empty" });
            await row.locator(".codicon-testing-failed-icon").waitFor();
            await window.run("View: Focus Problems");
            await page.locator(".panel .composite-bar .action-label", { hasText: "Properties" }).click();
            const sentences = page.locator(".panel .monaco-list-row", { hasText: /0, exact.* · never_empty/ });
            await sentences.first().waitFor();
            await page
                .locator(".view-line", { hasText: /docks_only_when_low.*exact/ })
                .first()
                .waitFor();
            await page.mouse.move(640, 400); // the hover of the tab would cover the text
            await page.locator(".workbench-hover").first().waitFor({ state: "detached" });
            await window.screenshot(`verify-${theme}`, { x: 348, y: 35, width: 932, height: 703 });
            // The run goes on to the violation.
            await window.run("View: Toggle Panel Visibility");
            await window.openFile("main.xml");
            const toolbar = page.locator(".debug-toolbar");
            await window.pressBound("F5");
            await toolbar.waitFor();
            await page
                .getByText(/step \d+, /)
                .first()
                .waitFor();
            await window.run("AS2FM: Open Stage");
            const stage = await window.picture(".pane-timeline .drawing > svg");
            await window.run("View: Toggle Primary Side Bar Visibility");
            await window.run("Debug: Continue");
            await stage.locator(".pane-properties .verdict-failed").first().waitFor();
            await stage.locator(".pane-timeline .mark").first().waitFor({ state: "attached" });
            await window.screenshot(`debug-${theme}`, { x: 48, y: 35, width: 1232, height: 703 });
        });
    }
}
