// SPDX-License-Identifier: Apache-2.0
/** The actions of a user in a window of VS Code, and the visible results. Waits for visible text, never for a time. */

import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { setTimeout as wait } from "node:timers/promises";
import { isDeepStrictEqual } from "node:util";
import type { Frame, Locator, Page } from "playwright-core";
import { OUTPUT, VERSION } from "./paths";

export class Window {
    private timeout = TIMEOUT_MS;

    constructor(
        readonly page: Page,
        readonly folder: string,
    ) {}

    /** Sets the time limit for each wait, in ms. */
    limit(timeout: number): void {
        this.timeout = timeout;
        this.page.setDefaultTimeout(timeout);
    }

    /**
     * Opens the file of the folder that has a name, as with Ctrl+P. The whole path is entered, because the search for a
     * name depends on lists of files that VS Code makes in the background and keeps.
     */
    async openFile(name: string): Promise<void> {
        const { page } = this;
        const base = path.basename(name);
        const file = path.join(this.folder, await this.until(() => onlyFile(this.folder, name)));
        const tab = page.locator(`.tab.active[data-resource-name="${base}"]`).first();
        const focused = this.focusedEditor.locator(".view-line").first();
        await this.until(async () => {
            await this.quickOpen("Control+P", file, `.quick-input-list .focused[aria-label*="${base}"]`);
            return (await this.enter()) && (await isShown(tab)) && (await isShown(focused));
        });
    }

    /**
     * Runs a command by its title in the palette. The palette lists the commands that are enabled when it opens, so it
     * is opened again until the command is enabled, for example after the server has classified the file.
     */
    async run(title: string): Promise<void> {
        await this.until(async () => {
            await this.quickOpen("F1", `>${title}`, `.quick-input-list .focused[aria-label^="${title}"]`);
            return await this.enter();
        });
    }

    /** Runs a command by its title until its quick input is visible. A view that gets the focus late closes it. */
    async runUntilAsked(title: string, question: string): Promise<void> {
        await this.repeat(() => this.run(title), this.question(question));
    }

    question(text: string): Locator {
        return this.page.locator(".quick-input-widget", { hasText: text });
    }

    /** Enters a text, or accepts the suggested one, in the quick input that asks a question. */
    async answer(question: string, text?: string): Promise<void> {
        await this.accept(this.question(question), text);
    }

    /** Presses Enter in the quick input until something in it is not visible any more. */
    async accept(shown: Locator, text?: string): Promise<void> {
        await shown.first().waitFor();
        await this.until(async () => {
            if (!(await shown.first().isVisible())) return true;
            if (text !== undefined) await this.quickInput.fill(text);
            await this.quickInput.focus(); // a picture may have taken it back
            return (await this.pressEnter()) && (await isShown(shown.first(), REPETITION_MS, "hidden"));
        });
    }

    /** Saves a file where a dialog proposes it, or elsewhere, and waits until it has a content. */
    async saveAs(proposed: string, file = proposed): Promise<void> {
        await this.until(async () => (await this.quickInput.inputValue()) === proposed);
        await this.accept(this.page.locator(".quick-input-widget"), file);
        await this.until(() => fs.existsSync(file) && fs.statSync(file).size > 0);
    }

    private get quickInput(): Locator {
        return this.page.locator(".quick-input-widget input[type=text]").first();
    }

    private get quickInputFocus(): Locator {
        return this.page.locator(".quick-input-widget :focus");
    }

    /** Presses Enter in the quick input. Resolves to whether it has closed or shows the next question. */
    private async enter(): Promise<boolean> {
        const input = this.quickInput;
        const text = await input.inputValue();
        return (await this.pressEnter()) && (!(await input.isVisible()) || (await input.inputValue()) !== text);
    }

    /**
     * Presses Enter if the quick input has the focus; otherwise the key would change the text of an editor. Resolves to
     * whether the quick input has received the key. It receives none if another view gets the focus just before.
     */
    private async pressEnter(): Promise<boolean> {
        const { page } = this;
        if (!(await this.quickInputFocus.first().isVisible())) return false;
        const key = await page.evaluateHandle(() => {
            const key = { isReceived: false };
            const receive = ({ target }: Event) => {
                key.isReceived = target instanceof Element && target.closest(".quick-input-widget") !== null;
            };
            window.addEventListener("keydown", receive, { capture: true, once: true });
            return key;
        });
        await page.keyboard.press("Enter");
        // The key is unknown after a command that reloads the window.
        return await key.evaluate(({ isReceived }) => isReceived).catch(() => true);
    }

    /** Repeats an action that has no effect when it is lost, and the same effect when it is done twice, until its
     * result is visible. */
    async repeat(action: () => Promise<unknown>, result: Locator): Promise<void> {
        await this.until(async () => {
            if (await result.first().isVisible()) return true;
            await action();
            return await isShown(result.first());
        });
    }

    /**
     * Opens the quick input with a key and enters a text, until it shows a row. A view or an editor that gets the focus
     * late, for example after a click on its tab, closes the quick input; then it is opened again.
     */
    private async quickOpen(key: string, text: string, row: string): Promise<void> {
        const { page } = this;
        const none = page.locator(".quick-input-list .monaco-list-row", { hasText: /No matching/ });
        const shown = page.locator(row);
        await this.until(async () => {
            await page.keyboard.press(key);
            const isAnswered = await page
                .locator(".quick-input-widget input")
                .fill(text, { timeout: REPETITION_MS })
                .then(() => shown.or(none).first().waitFor({ timeout: REPETITION_MS }))
                .then(
                    () => true,
                    () => false,
                );
            if (isAnswered && (await shown.first().isVisible())) return true;
            await this.closeQuickInput();
            return false;
        });
    }

    /** The titles in the palette that match a text. */
    async commands(text: string): Promise<string[]> {
        await this.quickOpen("F1", `>${text}`, `.quick-input-list .focused[aria-label^="${text}"]`);
        const rows = this.page.locator(".quick-input-list .monaco-list-row");
        const labels = await rows.evaluateAll((rows) => rows.map((row) => row.getAttribute("aria-label") ?? ""));
        await this.closeQuickInput();
        return labels;
    }

    /** Closes the quick input if it is open; otherwise the key would hide notifications. */
    private async closeQuickInput(): Promise<void> {
        if (await this.page.locator(".quick-input-widget").isVisible()) await this.page.keyboard.press("Escape");
    }

    /** Moves the caret to a line and column, counted from 1. */
    async goTo(line: number, column = 1): Promise<void> {
        const place = this.statusItem(`Ln ${line}, Col ${column}`);
        const row = `.quick-input-list .monaco-list-row[aria-label*="${line}"]`;
        await this.until(async () => {
            await this.quickOpen("Control+G", `:${line}:${column}`, row);
            return (await this.enter()) && (await isShown(place)) && (await isShown(this.focusedEditor));
        });
    }

    /** Moves the caret after the first occurrence of a text in a file of the workspace. */
    async goBehind(file: string, text: string): Promise<void> {
        const [line, column] = this.placeIn(file, text);
        await this.goTo(line, column + text.length);
    }

    /** What the status bar shows if the caret is in front of a text of a file of the folder. */
    positionOf(file: string, text: string): string {
        const [line, column] = this.placeIn(file, text);
        return `Ln ${line}, Col ${column}`;
    }

    /** The line and the column, both from 1, at which a text of a file of the folder begins. */
    placeIn(file: string, text: string): [number, number] {
        return placeOf(fs.readFileSync(path.join(this.folder, file), "utf8"), text);
    }

    /** Closes what a test has opened: editors, without saving them, the panel, and notifications. */
    async closeAll(): Promise<void> {
        const { page } = this;
        await this.press("Escape", "Escape");
        const tabs = page.locator(".editor-group-container .tab");
        const discard = page.locator(".monaco-dialog-box").getByRole("button", { name: "Don't Save" });
        await this.until(async () => {
            if ((await tabs.count()) === 0) return true;
            if (await discard.isVisible()) await discard.click();
            else await this.run("View: Close All Editors");
            return (await tabs.count()) === 0;
        });
        if (await page.locator(".part.panel .composite.panel").isVisible()) await this.run("View: Hide Panel");
        await this.run("Notifications: Clear All Notifications"); // also those that are not visible any more
    }

    async save(): Promise<void> {
        await this.page.keyboard.press("Control+S");
        await this.page.locator(".tab.active:not(.dirty)").first().waitFor();
    }

    /** The focused editor, otherwise the first one. */
    get editor(): Locator {
        return this.page
            .locator(
                ".editor-group-container.active .monaco-editor[role='code'], .editor-group-container.active .monaco-editor",
            )
            .first();
    }

    /** The editor whose text has the focus. */
    get focusedEditor(): Locator {
        return this.page.locator(".editor-group-container.active .monaco-editor.focused").first();
    }

    /** Shows an open file by a click on its tab, and waits until keys reach its text. */
    async clickTab(name: string): Promise<void> {
        const tab = this.page.locator(`.tab[data-resource-name="${name}"]`);
        const active = this.page.locator(`.tab.active[data-resource-name="${name}"]`).first();
        await this.until(async () => {
            await tab.first().click();
            return (await isShown(active)) && (await isShown(this.focusedEditor));
        });
    }

    /** Opens the list of quick fixes at the caret and applies the one with a text. */
    async quickFix(text: string, picture?: () => Promise<void>): Promise<void> {
        const fix = this.page.locator(".action-widget .monaco-list-row", { hasText: text }).first();
        await this.repeat(() => this.press("Escape", "Control+."), fix);
        await picture?.();
        await this.press("Enter");
    }

    get squiggles(): Locator {
        return this.page.locator(".squiggly-error");
    }

    statusItem(text: string): Locator {
        return this.page.locator(".statusbar-item", { hasText: text });
    }

    /** The number of problems in the status bar, when it is not zero. */
    get firstProblem(): Locator {
        return this.page.locator('[id="status.problems"]', { hasText: "1" });
    }

    notification(text: string): Locator {
        return this.page.locator(".notification-list-item", { hasText: text });
    }

    /**
     * Waits for a notification. One that nobody has read in time, or that was hidden by a key, is looked for in the
     * notification center, which stays open.
     */
    async notified(text: string, timeout = this.timeout): Promise<Locator> {
        const notification = this.notification(text).first();
        const center = this.page.locator(".notifications-center.visible");
        const end = Date.now() + timeout;
        while (!(await isShown(notification))) {
            if (Date.now() > end) throw new Error(`no notification says: ${text}`);
            if (!(await center.isVisible())) await this.run("Notifications: Show Notifications");
        }
        return notification;
    }

    /** Accepts the offer to install the language server. */
    async acceptInstallation(): Promise<void> {
        const offer = await this.notified("is not installed yet");
        const install = offer.getByRole("button", { name: "Install" });
        await this.repeat(() => offer.click(), install); // in the notification center, the button is hidden at first
        await install.click();
    }

    /** Waits until the language server runs. */
    async running(timeout = this.timeout): Promise<void> {
        await this.statusItem(`AS2FM: ${VERSION}`).waitFor({ timeout });
    }

    /** Waits until a value that is read from the page equals another one. */
    async becomes(get: () => Promise<unknown>, expected: unknown): Promise<void> {
        let value: unknown;
        await this.until(async () => {
            value = await get();
            return isDeepStrictEqual(value, expected);
        }).catch(() => {
            assert.deepEqual(value, expected);
        });
    }

    /** Waits for a condition that is not visible on the page; resolves to its value. */
    async until<T>(get: () => T | Promise<T>): Promise<NonNullable<T>> {
        const end = Date.now() + this.timeout;
        for (;;) {
            const value = await get();
            if (value) return value;
            if (Date.now() > end) throw new Error(`still not: ${get.toString()}`);
            await wait(INTERVAL_MS);
        }
    }

    /** The text of the line with the caret of an editor group. */
    async caretLine(group: number): Promise<string> {
        const editor = this.page.locator(".editor-group-container").nth(group);
        const caret = await editor.locator(".cursors-layer .cursor").first().boundingBox();
        const lines = await editor.locator(".view-line").all();
        for (const line of lines) {
            const box = await line.boundingBox();
            if (caret && box && Math.abs(box.y - caret.y) < 3) return plain((await line.textContent()) ?? "");
        }
        return "";
    }

    async press(...keys: string[]): Promise<void> {
        for (const key of keys) await this.page.keyboard.press(key);
    }

    /**
     * Presses a key with a command until the workbench runs the command. It does so only if the command is enabled, for
     * example after it has noticed that a run has stopped. The focus is not in a picture, which hides the key.
     */
    async pressBound(key: string): Promise<void> {
        await this.until(async () => {
            const pressed = await this.page.evaluateHandle(() => {
                const pressed = { isUsed: false };
                // The listener of the workbench is on the same object, and was added before. The keys of modifiers come
                // first.
                const look = (event: KeyboardEvent) => {
                    if (["Control", "Shift", "Alt", "Meta"].includes(event.key)) return;
                    pressed.isUsed = event.defaultPrevented;
                    window.removeEventListener("keydown", look);
                };
                window.addEventListener("keydown", look);
                return pressed;
            });
            await this.page.keyboard.press(key);
            return await pressed.evaluate(({ isUsed }) => isUsed);
        });
    }

    async type(text: string): Promise<void> {
        await this.page.keyboard.type(text);
    }

    /** The document of a diagram, inside the frames of its webview; if there are several, the one with content. */
    async picture(shown = "svg.picture"): Promise<Frame> {
        const end = Date.now() + this.timeout;
        while (Date.now() < end) {
            for (const frame of this.page.frames()) {
                if (
                    await frame
                        .locator(shown)
                        .count()
                        .catch(() => 0)
                )
                    return frame;
            }
            await this.page.waitForEvent("framenavigated", { timeout: 1000 }).catch(() => undefined);
        }
        await this.screenshot("failed-picture");
        throw new Error(`no webview shows ${shown}; see failed-picture.png`);
    }

    /** Saves a picture of the window or a part of it, for the README and the walkthrough. */
    async screenshot(name: string, clip?: Clip): Promise<void> {
        fs.mkdirSync(OUTPUT, { recursive: true });
        await this.page.screenshot({ path: path.join(OUTPUT, `${name}.png`), ...(clip ? { clip } : {}) });
    }
}

export interface Clip {
    readonly x: number;
    readonly y: number;
    readonly width: number;
    readonly height: number;
}

/** The time limit for a wait, in ms. It only prevents an endless wait. */
export const TIMEOUT_MS = 120_000;

/** The time limit for a wait of a test that will be repeated, in ms. What takes longer has probably been lost. */
export const FIRST_TIMEOUT_MS = 60_000;

/** The time limit for the installation of the server, in ms. Creating an environment may take minutes. */
export const INSTALLATION_TIMEOUT_MS = 300_000;

/** The time between two looks at a condition, in ms. A look at each frame would take a third of a core. */
const INTERVAL_MS = 50;

/** The time after which an action is repeated if its result is not visible, in ms. */
const REPETITION_MS = 20_000;

/** Whether an element becomes visible, or hidden, within a time in ms; by default, before the action is repeated. */
export function isShown(
    element: Locator,
    timeout = REPETITION_MS,
    state: "visible" | "hidden" = "visible",
): Promise<boolean> {
    return element.waitFor({ timeout, state }).then(
        () => true,
        () => false,
    );
}

/** The path of a file in a folder, or of the only one with a name in its folders; undefined if there is none yet. */
function onlyFile(folder: string, name: string): string | undefined {
    const files = fs.readdirSync(folder, { recursive: true, encoding: "utf8" });
    if (files.includes(name)) return name;
    const found = files.filter((file) => file.endsWith(`${path.sep}${name}`));
    if (found.length > 1) throw new Error(`${name} is ambiguous: ${found.join(", ")}`);
    return found[0];
}

/** A text with the spaces that the editor draws. */
function plain(text: string): string {
    return text.replaceAll("\u00a0", " ");
}

/** Line and column of a text, counted from 1. */
export function placeOf(content: string, text: string): [line: number, column: number] {
    const at = content.indexOf(text);
    if (at < 0) throw new Error(`${text} is not there`);
    const before = content.slice(0, at).split("\n");
    return [before.length, (before.at(-1) ?? "").length + 1];
}
