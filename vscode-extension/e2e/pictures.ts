// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import type { Frame, Locator, Page } from "playwright-core";
import { fleet, MEND, sample, SharedFolder, type Stage } from "./support/stage";
import { OUTPUT } from "./support/paths";
import type { Window } from "./support/window";
import { temporaryFolder, write } from "./support/workbench";

export function pictures(stage: Stage): void {
    stage.use();
    const mended = new SharedFolder(() => sample(MEND));

    stage.test("a machine: its states, navigation by click and by caret", mended, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        await window.run("AS2FM: Show State Machine");
        const picture = await window.picture();
        await window.becomes(() => labels(picture), ["driving", "charging"]);
        assert.equal(await picture.locator(".scene .edge.is-ros").count(), 3);
        assert.equal(await picture.locator("svg.picture .dot").count(), 1);
        assert.equal(await picture.locator("svg.picture .link .line:not(.gap)").count(), 4);
        const inside = picture.locator('.node[data-label="driving"] .edge.is-ros');
        assert.match((await inside.textContent()) ?? "", /timer second.*publish \/battery/);
        await picture.locator('.node[data-label="charging"]').click();
        await window.statusItem(window.positionOf("nodes/battery.ascxml", '<state id="charging"')).waitFor();
        await picture.locator('.node.here[data-label="charging"]').waitFor();
        await window.screenshot("machine");
        await window.goBehind("nodes/battery.ascxml", "Math.max(");
        await picture.locator(".edge.here").first().waitFor();
        // Another machine is drawn when its editor becomes active. Edits are shown before they are saved.
        await window.openFile("building.ascxml");
        await picture.locator('.node[data-label="open"]').waitFor();
        await window.becomes(() => picture.locator(".scene .edge.is-chance").count(), 2);
        await window.goBehind("nodes/building.ascxml", '<state id="open');
        await window.type("ed");
        await picture.locator('.node[data-label="opened"]').waitFor();
    });

    stage.test("the behavior tree and its ports", mended, async (window) => {
        await window.openFile("tree.xml");
        await window.running();
        await window.run("AS2FM: Show Behavior Tree");
        const picture = await window.picture();
        const names = ["ReactiveSequence", "ReactiveFallback", "BatteryAbove", "Charge", "Deliver"];
        await window.becomes(() => labels(picture), names);
        assert.match((await picture.locator('.node[data-label="Deliver"]').textContent()) ?? "", /parcels = 3/);
        assert.equal(await picture.locator(".link.is-child").count(), 4);
        await picture.locator('.node[data-label="Deliver"]').click();
        await window.statusItem("Ln 10, Col 13").waitFor();
        await window.screenshot("tree");
    });

    stage.test("the ROS graph: keyboard navigation and search", mended, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Show ROS Graph");
        const picture = await window.picture();
        const machines = ["Battery", "Building", "BatteryAbove", "Charge", "Deliver"];
        await window.becomes(() => labels(picture), [...machines, "/battery", "/dock", "/parcels", "/hand_over"]);
        // What is under the pointer, here where the last test clicked, would be highlighted.
        await window.page.mouse.move(640, 17);
        await picture.locator(".node").first().waitFor();
        await window.screenshot("ros-graph");
        await picture.locator("svg.picture").press("/");
        await window.type("hand");
        await picture.locator('.node.found[data-label="/hand_over"]').waitFor();
        await window.becomes(() => picture.locator(".node.found").count(), 1);
        await window.screenshot("search");
        await picture.getByRole("button", { name: "Only Results" }).click();
        await window.becomes(() => labels(picture), ["Building", "Deliver", "/hand_over"]);
        await picture.getByRole("button", { name: "Show All" }).click();
        await window.becomes(() => picture.locator(".node").count(), machines.length + 4);
        await picture.locator("svg.picture").press("/");
        await window.press("Escape");
        await picture.locator('.node[data-label="/dock"]').click();
        await picture.locator("svg.picture").press("Space");
        await window.becomes(() => picture.locator(".node").count(), 3);
        await window.screenshot("ros-graph-neighbors");
        await picture.locator("svg.picture").press("Space");
        await window.becomes(() => picture.locator(".node").count(), machines.length + 4);
        await picture.locator('.node[data-label="/hand_over"]').waitFor();
        await picture.locator("svg.picture").press("/");
        await window.press("Escape", "ArrowLeft");
        await picture.locator(".node.selected:not([data-label='/hand_over'])").waitFor();
        await picture.locator('.node[data-label="/hand_over"]').click();
        await window.page.locator('.tab.active[data-resource-name="building.ascxml"]').waitFor();
        await picture.locator('.node.here[data-label="/hand_over"], .edge.here').first().waitFor();
    });

    stage.test("the ROS graph: a namespace is collapsed and opened again", fleet, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Show ROS Graph");
        const picture = await window.picture();
        const anna = picture.locator('.node[data-label="/anna"]');
        await anna.locator(".frame").waitFor();
        const all = await labels(picture);
        await window.screenshot("ros-graph-namespaces");
        await anna.getByText("/anna").click();
        await picture.locator("svg.picture").press("Space");
        await anna.filter({ hasText: "… 6 parts" }).locator(".card").waitFor();
        await window.becomes(() => picture.locator(".node").count(), all.length - 6);
        await window.screenshot("ros-graph-collapsed");
        await anna.getByText("/anna").dblclick();
        await window.becomes(() => labels(picture), all);
    });

    stage.test("a machine: a group of states is collapsed and opened again", grouped, async (window) => {
        await window.openFile("docker.ascxml");
        await window.running();
        await window.run("AS2FM: Show State Machine");
        const picture = await window.picture();
        const docking = picture.locator('.node[data-label="Docking"]');
        await docking.locator(".frame").waitFor();
        const all = await labels(picture);
        await window.screenshot("machine-groups");
        await docking.getByText("Docking").click();
        await picture.locator("svg.picture").press("Space");
        await docking.filter({ hasText: "… 2 states" }).locator(".card").waitFor();
        await window.becomes(() => labels(picture), ["idle", "Docking"]);
        await window.screenshot("machine-group-collapsed");
        await docking.getByText("Docking").dblclick();
        await window.becomes(() => labels(picture), all);
    });

    stage.test(
        "actions on a machine change its text, with the pointer and with the keyboard",
        mended,
        async (window) => {
            const { page } = window;
            await window.openFile("battery.ascxml");
            await window.running();
            await window.run("AS2FM: Show State Machine");
            const picture = await window.picture();
            const text = page.locator(".monaco-editor .view-lines").first();
            const driving = picture.locator('.node[data-label="driving"]');

            await driving.click({ button: "right", position: { x: 20, y: 12 } });
            await menuItem(page, "Set as Initial State").waitFor({ state: "detached" });
            await window.screenshot("picture-menu");
            await chooseItem(window, "Add State…");
            await window.answer("The name of the new state", "resting");
            await picture.locator('.node[data-label="resting"]').waitFor();

            // The keyboard opens the menu of the selected node.
            await picture.locator('.node[data-label="resting"]').click();
            await window.statusItem(window.positionOf("nodes/battery.ascxml", '<state id="charging"')).waitFor();
            const shortcut = () => picture.locator("svg.picture").press("Shift+F10");
            await window.repeat(shortcut, menuItem(page, "Add Transition…"));
            const focused = page.locator(".monaco-menu .action-item.focused", { hasText: "Add Transition…" });
            await window.until(async () => {
                if (await focused.isVisible()) return true;
                await window.press("ArrowDown");
                return false;
            });
            await window.press("Enter");
            await choose(window, "The target of the transition", "driving");
            await choose(window, "The trigger of the transition", "timer second");
            await picture.locator('[data-edges][aria-label^="resting → driving"]').first().waitFor();
            await text.getByText("resting").first().waitFor();
            await window.screenshot("picture-actions");

            // A name that exists is refused while it is typed.
            await picture.locator('.node[data-label="resting"]').click({ button: "right" });
            await chooseItem(window, "Rename…");
            await page.locator(".quick-input-widget", { hasText: "The new name of" }).waitFor();
            await page.locator(".quick-input-widget input").first().fill("driving");
            await page.locator(".quick-input-widget", { hasText: "already exists" }).waitFor();
            await window.answer("The new name of", "idle");
            await picture.locator('.node[data-label="idle"]').waitFor();

            await picture.locator('.node[data-label="idle"]').click({ button: "right" });
            await chooseItem(window, "Set as Initial State");
            await text.getByText("idle").first().waitFor();
            await picture.locator('.node[data-label="idle"]').click({ button: "right" });
            await chooseItem(window, "Delete");
            await picture.locator('.node[data-label="idle"]').waitFor({ state: "detached" });

            // Undo in the text restores the state.
            await window.clickTab("battery.ascxml");
            await window.press("Control+Z");
            await picture.locator('.node[data-label="idle"]').waitFor();
        },
    );

    stage.test("actions on a tree change its text", mended, async (window) => {
        const { page } = window;
        await window.openFile("tree.xml");
        await window.running();
        await window.run("AS2FM: Show Behavior Tree");
        const picture = await window.picture();
        const nodeOf = (label: string) => picture.locator(`.node[data-label="${label}"]`);
        const openMenu = (label: string) => nodeOf(label).click({ button: "right", position: { x: 20, y: 12 } });

        await nodeOf("Charge").waitFor();
        await openMenu("ReactiveFallback");
        await menuItem(page, "Set Name…").waitFor();
        await menuItem(page, "Add Child…").waitFor();
        await window.screenshot("tree-menu");
        await chooseItem(window, "Add Child…");
        await window.question("The node to add").waitFor();
        await page.locator(".quick-input-widget input").first().fill("RetryUntil");
        await choose(window, "The node to add", "RetryUntilSuccessful");
        await window.answer("num_attempts", "3");
        await nodeOf("RetryUntilSuccessful").filter({ hasText: "num_attempts = 3" }).waitFor();
        await window.screenshot("tree-actions");

        await openMenu("Charge");
        await chooseItem(window, "Move Earlier");
        await window.until(async () => {
            const now = await labels(picture);
            return now.indexOf("Charge") < now.indexOf("BatteryAbove");
        });
        await openMenu("Deliver");
        await chooseItem(window, "Wrap in…");
        await choose(window, "The node around it", "Inverter");
        await nodeOf("Inverter").waitFor();
        await openMenu("Deliver");
        await chooseItem(window, "Set Name…");
        await window.answer("The name of the node", "last");
        await nodeOf("last : Deliver").waitFor();
        await openMenu("Inverter");
        await chooseItem(window, "Remove, Keep Children");
        await nodeOf("Inverter").waitFor({ state: "detached" });
        await openMenu("RetryUntilSuccessful");
        await chooseItem(window, "Delete");
        await nodeOf("RetryUntilSuccessful").waitFor({ state: "detached" });

        // Each action is undone in the text.
        await window.clickTab("tree.xml");
        await window.press("Control+Z");
        await nodeOf("RetryUntilSuccessful").waitFor();
        await window.press("Control+Z");
        await nodeOf("Inverter").waitFor();
    });

    stage.test("a diagram is saved as SVG, PNG and PDF", mended, async (window) => {
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Show ROS Graph");
        const picture = await window.picture();
        for (const format of ["SVG", "PNG", "PDF"]) {
            await picture.getByRole("button", { name: `Save as ${format}` }).click();
            const file = path.join(window.folder, `main.ros.${format.toLowerCase()}`);
            await window.saveAs(file);
        }
        const svg = fs.readFileSync(path.join(window.folder, "main.ros.svg"), "utf8");
        assert.match(svg, /^<svg xmlns="http:\/\/www.w3.org\/2000\/svg"/);
        assert.match(svg, />\/hand_over</);
        const theme = svg.replace(/^.*<style>/s, "").replace(/<\/style>.*$/s, "");
        assert.match(theme, /-card \{ fill: #/);
        assert.doesNotMatch(svg, /var\(--/);
        const png = fs.readFileSync(path.join(window.folder, "main.ros.png"));
        assert.equal(png.subarray(1, 4).toString(), "PNG");
        const pdf = fs.readFileSync(path.join(window.folder, "main.ros.pdf"));
        assert.match(pdf.toString("latin1"), /^%PDF-1\.4[^]*%%EOF\n$/);
        keep(window.folder, "main.ros.svg", "main.ros.png", "main.ros.pdf");
    });

    stage.test("a large tree without a system: map, search and collapsed nodes", largeTree, async (window) => {
        await window.openFile("tour.xml");
        await window.running();
        await window.run("AS2FM: Show Behavior Tree");
        const picture = await window.picture();
        const map = picture.locator(".minimap:not(.hidden)");
        await map.waitFor();
        const all = await labels(picture);
        assert.equal(all.filter((label) => label === "Spin").length, VISITS);

        // The results are emphasised in the picture and in the map; the map does not cover the first one.
        await picture.locator("svg.picture").press("/");
        await window.type("dock");
        const results = picture.locator(".node.found");
        await results.first().waitFor({ state: "attached" });
        await window.becomes(() => labels(picture, ".node.found"), Array<string>(VISITS / 3).fill("DockRobot"));
        await window.becomes(() => map.locator(".minimap-node.found").count(), VISITS / 3);
        const [result, corner] = [await results.first().boundingBox(), await map.boundingBox()];
        assert.ok(result && corner);
        const isApart = (at: number, size: number, other: number, otherSize: number) =>
            at + size <= other || other + otherSize <= at;
        assert.ok(
            isApart(result.x, result.width, corner.x, corner.width) ||
                isApart(result.y, result.height, corner.y, corner.height),
        );
        await window.screenshot("large-tree");
        await window.press("Enter");
        await window.until(async () => {
            const second = await results.nth(1).getAttribute("class");
            return second?.includes("selected");
        });
        await window.press("Escape");
        await results.first().waitFor({ state: "detached" });

        // The first visit is found, collapsed, and opened again.
        await window.press("/");
        await window.type("visit 0");
        const visit = picture.locator('.node[data-label="visit 0 : RecoveryNode"]');
        await visit.and(picture.locator(".selected")).waitFor();
        await window.press("Escape", "Space");
        await visit.filter({ hasText: "… 10 nodes" }).waitFor();
        assert.equal((await labels(picture)).filter((label) => label === "Spin").length, VISITS - 1);
        await window.screenshot("large-tree-collapsed");
        await window.press("Space");
        await visit.filter({ hasNotText: "…" }).waitFor();
        await window.becomes(() => labels(picture), all);
    });
}

function menuItem(page: Page, label: string): Locator {
    return page.locator(".monaco-menu .action-label").getByText(label, { exact: true });
}

/** A menu that has just opened ignores clicks, so the click is repeated until the menu closes. */
async function chooseItem(window: Window, label: string): Promise<void> {
    const item = menuItem(window.page, label);
    await item.waitFor();
    await window.until(async () => {
        if (await item.isVisible()) await item.click({ timeout: 1000 }).catch(() => undefined);
        return !(await item.isVisible());
    });
}

async function choose({ page }: Window, title: string, option: string): Promise<void> {
    await page.locator(".quick-input-widget", { hasText: title }).waitFor();
    await page.locator(".quick-input-list .monaco-list-row", { hasText: option }).first().click();
}

const VISITS = 12;

/** A tree of Nav2 that visits several places and belongs to no system. */
function largeTree(): string {
    const visit = (number: number) => `
        <RecoveryNode number_of_retries="3" name="visit ${number}">
            <PipelineSequence>
                <RateController hz="1.0"><ComputePathToPose goal="{goal_${number}}" path="{path}" /></RateController>
                <FollowPath path="{path}" />
            </PipelineSequence>
            <ReactiveFallback>
                <GoalUpdated />
                <RoundRobin>
                    <Spin spin_dist="1.57" />
                    <Wait wait_duration="5" />
                    ${number % 3 === 0 ? '<DockRobot dock_id="dock" />' : '<BackUp backup_dist="0.3" backup_speed="0.05" />'}
                </RoundRobin>
            </ReactiveFallback>
        </RecoveryNode>`;
    const visits = Array.from({ length: VISITS }, (_, number) => visit(number)).join("");
    const tree = `<BehaviorTree ID="Tour"><Sequence>${visits}</Sequence></BehaviorTree>`;
    const folder = temporaryFolder("tour");
    write(path.join(folder, "tour.xml"), `<root BTCPP_format="4" main_tree_to_execute="Tour">${tree}</root>\n`);
    return folder;
}

/** A folder with a machine, two of whose states are in a region. */
function grouped(): string {
    const text = `<ascxml name="Docker" version="1.0" initial="idle">
  <state id="idle">
    <transition event="dock" target="search" />
  </state>
  <!-- #region Docking -->
  <state id="search">
    <transition event="seen" target="approach" />
  </state>
  <state id="approach">
    <transition event="lost" target="search" />
    <transition event="docked" target="idle" />
  </state>
  <!-- #endregion -->
</ascxml>
`;
    const folder = temporaryFolder("docker");
    write(path.join(folder, "docker.ascxml"), text);
    return folder;
}

function labels(picture: Frame, nodes = ".node"): Promise<string[]> {
    return picture.locator(nodes).evaluateAll((nodes) => nodes.map((node) => node.getAttribute("data-label") ?? ""));
}

function keep(folder: string, ...names: string[]): void {
    for (const name of names) fs.copyFileSync(path.join(folder, name), path.join(OUTPUT, name));
}
