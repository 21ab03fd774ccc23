// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import type { Frame, Locator } from "playwright-core";
import { fleet, MEND, sample, type Stage } from "./support/stage";
import { themes } from "./support/themes";
import type { Window } from "./support/window";
import { ROOT } from "./support/paths";
import { temporaryFolder, write } from "./support/workbench";

const PROPERTY = "never_placed_empty";
/** The position of a run, above its choices. */
const POSITION = /step (\d+), /;

/** A copy of the robot that drops the block. The configuration leaves the system to the active file. */
function robot(attributes: object, theme?: string): string {
    const folder = path.join(temporaryFolder("robot"), "assembly_robot");
    fs.cpSync(path.join(ROOT, "examples/assembly_robot"), folder, { recursive: true });
    if (theme !== undefined)
        write(path.join(folder, ".vscode/settings.json"), JSON.stringify({ "workbench.colorTheme": theme }));
    const configuration = { type: "as2fm", request: "launch", name: "Debug", ...attributes };
    const configurations = { version: "0.2.0", configurations: [configuration] };
    write(path.join(folder, ".vscode/launch.json"), JSON.stringify(configurations));
    return folder;
}

/** A tree that belongs to no system, with a file of mocks. F5 needs no `launch.json`. */
function loneTree(): string {
    const folder = temporaryFolder("tree");
    fs.cpSync(path.join(ROOT, "examples/fetch_tree"), folder, { recursive: true });
    return folder;
}

/** The delivery robot; its tree writes the number of parcels on the blackboard. */
function withBlackboard(): string {
    const asInteger = (text: string) => text.replace('type="uint8"', 'type="int32"');
    return sample({
        ...MEND,
        "tree.xml": (text) =>
            text.replace(
                '<Deliver parcels="3" />',
                '<SetBlackboard value="3" output_key="{parcels}" /><Deliver parcels="{parcels}" />',
            ),
        "plugins/deliver.ascxml": (text) =>
            text
                .replace(/<bt_declare_port_in [^>]*>/, asInteger)
                .replace(/<data id="wanted"[^]*?<\/data>/, '<data id="wanted" type="int32" expr="3" />')
                .replace(
                    '<bt_tick target="carrying">',
                    '<bt_tick target="carrying">' +
                        '<assign location="wanted"><expr><bt_get_input key="parcels" /></expr></assign>',
                ),
    });
}

export function debugging(stage: Stage): void {
    stage.use();
    const fromStart = () => robot({ seed: 3 });

    for (const [look, theme] of themes("light", "light", "dark")) {
        const dropping = () => robot({ property: PROPERTY, against: 1 }, theme);
        stage.test(
            `F5 goes to the dropped block, and back to where chance decides otherwise, ${look}`,
            dropping,
            async (window) => {
                const { page } = window;
                await window.openFile("arm.ascxml");
                await window.running();
                await window.goBehind("arm.ascxml", '<target id="moving">');
                await window.pressBound("F9");
                await page.locator(".codicon-debug-breakpoint, .codicon-debug-breakpoint-unverified").first().waitFor();
                await window.openFile("main_with_bug.xml");
                await startRun(window);
                const frame = page
                    .locator(".debug-call-stack .monaco-list-row", { hasText: "Arm: <target> by chance" })
                    .first();
                const choices = choicesOf(window);

                await makeSpace(window);

                // The run stops before the arm drops the block.
                await frame.waitFor();
                await page.locator('.tab.active[data-resource-name="arm.ascxml"]').waitFor();
                await window.editor
                    .locator(".view-line", { hasText: /holding\s=\strue/ })
                    .first()
                    .waitFor();
                await choices.getByText("is not decided yet").waitFor();
                await choices.locator(".monaco-list-row", { hasText: "way := 2, Arm enters" }).first().waitFor();
                await window.screenshot(`debugging-${look}`);

                // After a turn it is dropped. Backwards, the run stops where chance decides.
                await button(window, "Step Over").click();
                await frame.waitFor({ state: "detached" });
                await button(window, "Reverse").click();
                await frame.waitFor();

                // The arm keeps the block, and the property holds to the end.
                await choices.getByText("way := 2, Arm enters").first().click();
                await choices.getByText("chosen by the user").first().waitFor();
                await window.pressBound("F5");
                await choices.getByText(`The property ${PROPERTY} holds in this run.`).waitFor();
                await page.locator(".debug-call-stack").getByText("Violated: block_dropped").first().waitFor();
                await choices.locator(".monaco-list-row").first().waitFor({ state: "detached" });
                await window.screenshot("debugging-choice");
                await stop(window);
            },
        );
    }

    stage.test("F5 on a tree without a system runs it with the mocks beside it", loneTree, async (window) => {
        const { page } = window;
        await window.openFile("fetch.xml");
        await window.running();
        await window.goBehind("fetch.xml", "<FollowPath");
        await window.pressBound("F9");
        await page.locator(".codicon-debug-breakpoint, .codicon-debug-breakpoint-unverified").first().waitFor();
        await startRun(window);
        await choicesOf(window).getByText(POSITION).first().waitFor();
        await makeSpace(window);
        await window.pressBound("F5");
        const stack = page.locator(".debug-call-stack .monaco-list-row");
        await stack.filter({ hasText: "FollowPath: TICKED" }).first().waitFor();
        await choicesOf(window).getByText("FollowPath is ticked").first().waitFor();
        await window.screenshot("debugging-tree");
        await stop(window);
    });

    stage.test("a run without debugging is shown on the stage, here that of a tree alone", loneTree, async (window) => {
        await window.openFile("fetch.xml");
        await window.running();
        await window.pressBound("Control+F5");
        await window.page.locator(".debug-toolbar").waitFor();
        const page = await window.picture('.pane-tree .node[data-label="FollowPath"][data-look]');
        await page.locator(".caption", { hasText: "The run has ended" }).waitFor();
        await window.screenshot("stage-tree");
        await window.becomes(() => page.locator(".pane:visible").count(), 3);
        await stop(window);
    });

    for (const [look, theme] of themes("light", "light", "dark")) {
        const themed = () => robot({ seed: 3 }, theme);
        stage.test(`the timeline shows the run, and a click moves the debugger, ${look}`, themed, async (window) => {
            const { page } = window;
            await start(window, "main_with_bug.xml");
            await window.pressBound("F5");
            await choicesOf(window).getByText("The property block_placed holds in this run.").waitFor();
            await page.locator(".panel .composite-bar .action-label", { hasText: "Timeline of the Run" }).click();
            const timeline = await window.picture(".drawing > svg");
            for (const lane of ["Arm", "PickUp", "MoveToGoal", "Place"])
                await timeline.locator(".names text", { hasText: lane }).first().waitFor();
            const end = await stepOf(timeline);
            await choicesOf(window).getByText(`step ${end},`).waitFor();
            await timeline.locator(".event[data-step]").first().waitFor();
            await window.screenshot(`timeline-${look}`);

            // A click beside all events goes to the time there.
            const rows = timeline.locator(".rows");
            const { width } = await boxOf(rows);
            await rows.click({ position: { x: width / 2, y: 3 } });
            const step = await window.until(async () => [await stepOf(timeline)].find((step) => step !== end));
            assert.ok(step > 0 && step < end, `step ${step} of ${end}`);
            await choicesOf(window).getByText(`step ${step},`).waitFor();
            await rows.press("ArrowLeft");
            await choicesOf(window)
                .getByText(`step ${step - 1},`)
                .waitFor();
            await rows.press("Shift+Home");
            await choicesOf(window).getByText("step 0,").waitFor();
            await timeline.locator(".selected-stretch").waitFor();
            await rows.press("Escape");
            await timeline.locator(".selected-stretch").waitFor({ state: "hidden" });

            // A selected stretch is exported.
            const { x, y } = await boxOf(rows);
            await page.keyboard.down("Shift");
            await page.mouse.move(x + width / 4, y + 3);
            await page.mouse.down();
            await page.mouse.move(x + width / 2, y + 3, { steps: 4 });
            await page.mouse.up();
            await page.keyboard.up("Shift");
            await timeline.locator(".selected-stretch").waitFor();
            await timeline.getByRole("button", { name: "Export the selection, or everything, as CSV" }).click();
            const file = path.join(window.folder, "main_with_bug.run.csv");
            await window.saveAs(file);
            const text = fs.readFileSync(file, "utf8");
            const lines = text.split("\n");
            assert.ok(lines.length > 10 && lines.length < end, `${lines.length} lines`);
            await stop(window);
        });
    }

    stage.test(
        "the stage follows the run, plays it, and moves it",
        () => robot({ property: PROPERTY, against: 1 }),
        async (window) => {
            await window.openFile("main_with_bug.xml");
            await window.running();
            await startRun(window);
            const end = await stepAfter(window, "does not hold in this run");
            // The stop shows the sentence and the values at the line that has sent the message.
            await window.page.locator(".debug-call-stack").getByText(`Violated: ${PROPERTY}`).first().waitFor();
            await window.page.locator('.tab.active[data-resource-name="arm.ascxml"]').waitFor();
            const lenses = window.page.locator(".codelens-decoration");
            const sentence = `${PROPERTY} is violated: The gripper is not opened at the goal without a block in it.`;
            await lenses.filter({ hasText: sentence }).first().waitFor();
            await lenses.filter({ hasText: "/block/placed: {data: false}, sent by Arm" }).first().waitFor();
            await window
                .statusItem(window.positionOf("arm.ascxml", '<field name="data" expr="holding &amp;'))
                .waitFor();
            await window.screenshot("violated");
            await window.run("AS2FM: Open Stage");
            const page = await window.picture(".pane-ros .node");
            const lookOf = (pane: string, label: string) =>
                page.locator(`.pane-${pane} .node[data-label="${label}"]`).first().getAttribute("data-look");
            // The violation is marked in the timeline, and the property is said.
            await page.locator(".pane-timeline .mark").first().waitFor({ state: "attached" });
            await page.locator(".pane-properties .verdict-failed").first().waitFor();
            await page.getByText("Curves").click();
            await page.getByLabel("Arm.way").check();
            await page.getByLabel("/arm/command.data").check();
            await page.locator(".pane-timeline .curve").first().waitFor({ state: "attached" });
            await page.getByText("Curves").click();
            await window.screenshot("stage-violated");

            // A click on a message goes to where it is received: it is lit in the graph, and its line in the text.
            await page.getByRole("button", { name: "Steps", exact: true }).click();
            const messages = page.locator(
                '.pane-timeline .event[data-step]:has(title:text("/arm/command: MoveToGoal"))',
            );
            // The drawing over steps replaces the one over time, perhaps during the click.
            // A message without a name and an arrow is its mark.
            const message = messages.first().locator("xpath=descendant-or-self::*[contains(@class, 'pulse')]");
            const click = () => done(message.click({ force: true }));
            const lit = page.locator('.pane-ros .node[data-label="/arm/command"][data-look="message"]');
            await window.repeat(() => window.until(click), lit);
            await page.locator(".pane-ros [data-edges].active").first().waitFor({ state: "attached" });
            await window.becomes(() => lookOf("system", "still"), "next");
            await window.page.locator('.tab.active[data-resource-name="arm.ascxml"]').waitFor();
            await window.screenshot("stage-message");

            // Played from there, it stops at a breakpoint, and then where the property fails.
            const from = await stepOf(page);
            await page.locator('.pane-ros .node[data-label="/arm/command"]').click({ modifiers: ["Alt"] });
            await page.locator(".pane-ros circle.breakpoint").waitFor();
            await page.getByRole("button", { name: "Play" }).click();
            await page.getByRole("button", { name: "Pause" }).waitFor();
            await page.getByLabel("Speed").selectOption({ label: "64 steps/s" });
            await page.getByRole("button", { name: "Play" }).click();
            await page.locator(".caption", { hasText: "/arm/command" }).waitFor();
            await page.getByRole("button", { name: "Play" }).waitFor();
            const stopped = await stepOf(page);
            assert.ok(from < stopped && stopped < end, `${from} < ${stopped} < ${end}`);
            await page.locator('.pane-ros .node[data-label="/arm/command"]').click({ modifiers: ["Alt"] });
            await page.locator(".pane-ros circle.breakpoint").waitFor({ state: "detached" });
            // Playing goes on when the timeline asks for its next part.
            for (let times = 0; times < 6; times++) await page.locator(".pane-timeline .rows").press("+");
            await page.getByRole("button", { name: "Play" }).click();
            await window.until(async () => (await stepOf(page)) === end);
            await choicesOf(window).getByText(`step ${end},`).first().waitFor();

            // A state that is selected in a picture marks its lane; its transitions are reached with the keyboard.
            await page.locator('.pane-system .node[data-label="still"]').first().click();
            await page.locator(".pane-timeline .names .lit", { hasText: "Arm" }).waitFor();
            // The click also shows the state in the text, which gets the focus. Before that, a key could reach the text.
            await window.statusItem(window.positionOf("arm.ascxml", '<state id="still">')).waitFor();
            await window.focusedEditor.waitFor();
            await page.locator(".pane-system > .pane-content > .middle svg").first().press("t");
            await page.locator(".pane-system [data-edges].selected").first().waitFor({ state: "attached" });
            await window.screenshot("stage-selected");
            await stop(window);
            await page.getByText("No run is being debugged.").first().waitFor();
            await window.becomes(() => page.locator(".node[data-look]").count(), 0);
        },
    );

    stage.test("a collapsed namespace has the messages of its topics", fleet, async (window) => {
        const { page } = window;
        await window.openFile("main.xml");
        await window.running();
        await window.run("AS2FM: Show ROS Graph");
        const picture = await window.picture();
        await picture.locator('.node[data-label="/anna/go_to"]').click({ modifiers: ["Alt"] });
        await picture.locator("circle.breakpoint").waitFor();
        const anna = picture.locator('.node[data-label="/anna"]');
        await anna.getByText("/anna").dblclick();
        await anna.filter({ hasText: "… 6 parts" }).locator(".card").waitFor();
        // In the group of the picture, a file would cover it.
        await window.clickTab("main.xml");
        await startRun(window);
        await choicesOf(window).getByText(POSITION).first().waitFor();
        await window.pressBound("F5");
        await page.locator(".debug-call-stack .monaco-list-row", { hasText: "<ros_topic_publish>" }).first().waitFor();
        await window.repeat(() => window.press("F10"), anna.and(picture.locator('[data-look="message"]')));
        await window.screenshot("ros-graph-message-inside");
        await stop(window);
        await window.becomes(() => picture.locator(".node[data-look]").count(), 0);
    });

    stage.test("a log point writes values, and a hit count stops at the third hit", fromStart, async (window) => {
        const { page } = window;
        await window.openFile("arm.ascxml");
        await window.running();
        const [log, third] = ["Debug: Add Logpoint", "Debug: Add Conditional Breakpoint"];
        await setBreakpoint(window, ['cond="way &lt; 6"', log, "Log Message", "on the way: {way}"]);
        await setBreakpoint(window, ['expr="way + 1"', third, "Hit Count", "3"]);
        await start(window, "main_with_bug.xml");
        await window.pressBound("F5");
        await page.locator(".debug-call-stack").getByText("Paused: arm.ascxml:54").first().waitFor();
        const logged = page.locator(".repl .monaco-list-row", { hasText: "on the way: " });
        for (const way of [0, 2, 3]) await logged.getByText(`on the way: ${way}`).first().waitFor();
        await window.becomes(() => logged.count(), 3);
        await window.screenshot("debugging-hits");
        await stop(window);
    });

    stage.test("a conditional breakpoint stops only where its condition is true", fromStart, async (window) => {
        const { page } = window;
        await window.openFile("arm.ascxml");
        await window.running();
        const title = "Debug: Add Conditional Breakpoint";
        await setBreakpoint(window, ['expr="way + 1"', title, "Expression", "way == 4"]);
        await page.locator(".codicon-debug-breakpoint-conditional").first().waitFor();
        await start(window, "main_with_bug.xml");

        // The line is reached with 0, 2 and 3 before.
        await window.pressBound("F5");
        await page.locator(".debug-call-stack").getByText("Paused: arm.ascxml:54").first().waitFor();
        const variables = page.locator(".pane", { has: page.locator('.pane-header[aria-label^="Variables"]') });
        await variables.locator(".monaco-list-row", { hasText: /^way\s*=?\s*4$/ }).waitFor();
        await window.screenshot("debugging-condition");

        // It is reached with 5 after that, and the run goes on to its end.
        await window.pressBound("F5");
        await choicesOf(window).getByText("The property block_placed holds in this run.").waitFor();
        await stop(window);
    });

    stage.test("a message that is published by hand is received", fromStart, async (window) => {
        await start(window, "main_with_bug.xml");
        const choices = choicesOf(window);
        const first = await stepAfter(window, "is not decided yet");
        await publish(window, "/arm/command", "{data: 2}");
        await choices.getByText("changed by the user").first().waitFor();
        await choices.getByText("The property block_placed is not decided yet.").waitFor();
        await choices.locator(".monaco-list-row", { hasText: "Arm receives a message" }).first().click();
        await choices
            .getByText(`step ${first + 2},`)
            .first()
            .waitFor();
        await choices.locator(".monaco-list-row", { hasText: "Arm receives a message" }).waitFor({ state: "detached" });
        await window.screenshot("by-hand");

        // Before the change, the run is one of the model again.
        await button(window, "Step Back").click();
        await choices
            .getByText(`step ${first + 1},`)
            .first()
            .waitFor();
        await button(window, "Step Back").click();
        await choices.getByText(`step ${first},`).first().waitFor();
        await choices.getByText("changed by the user").first().waitFor({ state: "detached" });
        await stop(window);
    });

    stage.test(
        "without a launch.json: a service is called and a blackboard entry is set by hand",
        withBlackboard,
        async (window) => {
            const { page } = window;
            await start(window, "main.xml");
            const choices = choicesOf(window);
            const first = await stepAfter(window, "is not decided yet");
            await publish(window, "/hand_over");
            await choices.getByText("changed by the user").first().waitFor();
            await choices.locator(".monaco-list-row", { hasText: "Building" }).first().waitFor();

            const variables = page.locator(".pane", { has: page.locator('.pane-header[aria-label^="Variables"]') });
            const scope = variables.locator(".monaco-list-row", { hasText: "Blackboard" }).first();
            const entry = variables.locator(".monaco-list-row", { hasText: /^parcels/ }).first();
            // VS Code expands the first scope, which is this one if the next machine has no variables.
            const collapsed = scope.and(page.locator('[aria-expanded="false"]'));
            await window.repeat(async () => {
                if (await collapsed.isVisible()) await collapsed.click();
            }, entry);
            // The input closes when another part of the workbench gets the focus.
            const input = variables.locator("input:visible");
            await window.repeat(async () => {
                if (!(await input.isVisible())) await entry.locator(".value").dblclick();
                await input.fill("7", { timeout: 2_000 }).catch(() => undefined);
                if (await input.isVisible()) await window.press("Enter");
            }, entry.getByText("7"));
            await choices
                .getByText(`step ${first + 2},`)
                .first()
                .waitFor();
            await window.screenshot("blackboard");
            await stop(window);
        },
    );
}

async function startRun(window: Window): Promise<void> {
    await window.pressBound("F5");
    await window.page.locator(".debug-toolbar").waitFor();
}

/** Sets a breakpoint with a condition, a hit count, or a message for the log, in the line of a text. */
async function setBreakpoint(window: Window, [place, title, kind, text]: readonly string[]): Promise<void> {
    const widget = window.page.locator(".breakpoint-widget");
    await window.goBehind("arm.ascxml", place ?? "");
    await window.repeat(() => window.run(title ?? ""), widget);
    await widget
        .locator("select")
        .first()
        .selectOption({ label: kind ?? "" });
    await window.type(text ?? "");
    await widget.locator(".view-line", { hasText: text?.replaceAll(" ", "\u00a0") ?? "" }).waitFor();
    await window.press("Enter");
    await widget.waitFor({ state: "detached" });
}

/** Starts a run of the system that stops at its start. */
async function start(window: Window, file: string): Promise<void> {
    await window.openFile(file);
    await window.running();
    await startRun(window);
    await choicesOf(window).getByText(POSITION).first().waitFor();
    await makeSpace(window);
}

/** The number of the step at which the run has stopped, after the view of choices shows a text. */
async function stepAfter(window: Window, text: string): Promise<number> {
    const choices = choicesOf(window);
    await choices.getByText(text).first().waitFor();
    return Number(POSITION.exec(await choices.getByText(POSITION).first().innerText())?.[1]);
}

/** A low window has no space for all views. */
async function makeSpace({ page }: Window): Promise<void> {
    await page.locator('.pane-header[aria-label^="Watch"][aria-expanded="true"]').click();
    await page.locator('.pane-header[aria-label^="Breakpoints"][aria-expanded="true"]').click();
}

async function stop(window: Window): Promise<void> {
    await button(window, "Stop").click();
    await window.page.locator(".debug-toolbar").waitFor({ state: "hidden" });
}

function choicesOf({ page }: Window): Locator {
    return page.locator(".pane").filter({ has: page.locator('.pane-header[aria-label^="Choices"]') });
}

/** Sends an event by hand. `fields` are missing if the event has none. */
async function publish(window: Window, name: string, fields?: string): Promise<void> {
    const { page } = window;
    await window.repeat(
        () => window.run("AS2FM: Publish Message"),
        page.locator(".quick-input-list .monaco-list-row", { hasText: name }),
    );
    await page.locator(".quick-input-widget input").first().fill(name);
    await window.accept(page.locator(`.quick-input-list .focused[aria-label*="${name}"]`));
    if (fields === undefined) return;
    await window.answer("The fields of", fields);
}

/** Whether an action has not failed. */
function done(action: Promise<unknown>): Promise<boolean> {
    return action.then(
        () => true,
        () => false,
    );
}

async function stepOf(timeline: Frame): Promise<number> {
    return Number(await timeline.locator("body").getAttribute("data-step"));
}

async function boxOf(locator: Locator): Promise<{ x: number; y: number; width: number; height: number }> {
    const box = await locator.boundingBox();
    if (!box) throw new Error("the element is not visible");
    return box;
}

function button(window: Window, name: string) {
    return window.page.locator(`.debug-toolbar .action-label[aria-label^="${name}"]`);
}
