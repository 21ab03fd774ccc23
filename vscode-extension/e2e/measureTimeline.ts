// SPDX-License-Identifier: Apache-2.0
/**
 * Frames while the timeline of a long run scrolls and zooms, and while the stage plays the run: the time between them,
 * the time in which the view handles the input and lays out the page, and the CPU time of its process. Only the CPU
 * time does not depend on what else the machine does.
 */

import type { Frame } from "playwright-core";
import { MEND, sample } from "./support/stage";
import { Workbench } from "./support/workbench";

const STEPS = 100_000;
const FRAMES = 300;

/** A robot that carries parcels for a long time. */
const LONG = {
    ...MEND,
    "main.xml": (text: string) => text.replace('max_time value="60"', 'max_time value="100000"'),
    "plugins/deliver.ascxml": (text: string) => text.replace("delivered + 1", "(delivered + 1) % 2"),
};

const workbench = await Workbench.start();
const window = await workbench.open(sample(LONG));
const { page } = window;
await window.openFile("main.xml");
await window.acceptInstallation();
await window.running();
await window.openFile("main.xml"); // the notification has taken the focus
await window.repeat(() => window.press("F5"), page.locator(".debug-toolbar"));
await page
    .getByText(/step \d+, /)
    .first()
    .waitFor();
await page.setViewportSize({ width: 1600, height: 900 }); // the panel has space for the names of all its views
await page.locator(".panel .composite-bar .action-label", { hasText: "Timeline of the Run" }).click();
let timeline = await window.picture(".drawing > svg");
await window.run("AS2FM: Go to Step");
await page.locator(".quick-input-widget", { hasText: "number of steps" }).waitFor();
await window.type(String(STEPS));
await window.press("Enter");
await timeline.locator(`body[data-step="${STEPS}"]`).waitFor();

await measure("timeline");

await window.run("AS2FM: Open Stage");
timeline = await window.picture(".pane-timeline .drawing > svg");
await measure("stage");
await timeline.getByLabel("Speed").selectOption({ label: "64 steps/s" });
await timeline.locator(".play").click();
await timeline.locator(`body:not([data-step="${STEPS}"])`).waitFor();
console.log(`stage, playing: ${await withCpu(() => frames(timeline))}`);
// Still playing: frames of a run that stands still would say nothing.
await timeline.getByRole("button", { name: "Pause" }).waitFor();
await workbench.stop();

/** The whole run becomes visible, then a hundredth of it. */
async function measure(name: string): Promise<void> {
    await timeline.getByRole("button", { name: "Fit", exact: true }).last().click();
    const zoom = { deltaX: 0, deltaY: -4, ctrlKey: true };
    console.log(`${name}, zooming: ${await withCpu(() => frames(timeline, zoom))}`);
    const scroll = { deltaX: -40, deltaY: 0, ctrlKey: false };
    console.log(`${name}, scrolling: ${await withCpu(() => frames(timeline, scroll))}`);
}

/** The text of a measurement with the CPU time of the process and of the main thread of the view, in ms for each frame. */
async function withCpu(measured: () => Promise<string>): Promise<string> {
    // A webview may share the process of the workbench.
    const session = await page
        .context()
        .newCDPSession(timeline)
        .catch(() => page.context().newCDPSession(page));
    await session.send("Performance.enable", { timeDomain: "threadTicks" });
    const read = async () => {
        const { metrics } = await session.send("Performance.getMetrics");
        const of = (name: string) => metrics.find((metric) => metric.name === name)?.value ?? NaN;
        return { process: of("ProcessTime"), thread: of("ThreadTime") };
    };
    const before = await read();
    const text = await measured();
    const after = await read();
    const each = (one: number, other: number) => (((other - one) * 1000) / FRAMES).toFixed(1);
    return `${text}; CPU for each frame ${each(before.process, after.process)} ms, main thread ${each(before.thread, after.thread)} ms`;
}

/** Sends one event of the wheel, if any, in each frame; the median and the 95th percentile of the times in ms. */
async function frames(view: Frame, wheel?: { deltaX: number; deltaY: number; ctrlKey: boolean }): Promise<string> {
    const measured = await view.evaluate(
        ({ wheel, count }) =>
            new Promise<{ between: number[]; inside: number[] }>((resolve) => {
                const rows = document.querySelector(".rows");
                const { left = 0, width = 0, top = 0 } = rows?.getBoundingClientRect() ?? {};
                const [between, inside]: [number[], number[]] = [[], []];
                let previous = performance.now();
                const frame = () => {
                    const begin = performance.now();
                    between.push(begin - previous);
                    previous = begin;
                    const place = { clientX: left + width / 2, clientY: top + 5 };
                    const event = { bubbles: true, cancelable: true, ...place, ...wheel };
                    if (wheel) rows?.dispatchEvent(new WheelEvent("wheel", event));
                    document.body.getBoundingClientRect(); // computes the layout
                    inside.push(performance.now() - begin);
                    if (between.length < count) requestAnimationFrame(frame);
                    else resolve({ between: between.slice(1), inside });
                };
                requestAnimationFrame(frame);
            }),
        { wheel, count: FRAMES },
    );
    const late = measured.between.filter((time) => time > 1000 / 30).length;
    return (
        `between frames ${summary(measured.between)}, ${late} of ${FRAMES} after more than 33 ms; ` +
        `input and layout ${summary(measured.inside)}`
    );
}

function summary(times: readonly number[]): string {
    const sorted = times.toSorted((a, b) => a - b);
    const at = (part: number) => (sorted[Math.floor(part * (sorted.length - 1))] ?? NaN).toFixed(1);
    return `${at(0.5)} ms, 95th percentile ${at(0.95)} ms`;
}
