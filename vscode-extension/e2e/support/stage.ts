// SPDX-License-Identifier: Apache-2.0
import * as fs from "node:fs";
import * as path from "node:path";
import { after, afterEach, before, test } from "node:test";
import { Window } from "./window";
import { EXTENSION } from "./paths";
import { temporaryFolder, Workbench, type Options } from "./workbench";

/** A workbench that the groups of tests share, with the server's environment that the first group has created. */
export class Stage {
    private running: Workbench | undefined;
    private current: Window | undefined;
    home: string | undefined;

    /** Starts the workbench for a group of tests; different options need a different workbench. */
    use(options: Options = {}): void {
        before(async () => {
            this.running = await Workbench.start({
                ...(this.home === undefined ? {} : { home: this.home }),
                ...options,
            });
            this.home = this.running.home;
        });
        afterEach(async () => {
            await this.current?.close();
            this.current = undefined;
        });
        after(async () => {
            await this.running?.stop();
        });
    }

    get workbench(): Workbench {
        if (!this.running) throw new Error("no workbench runs");
        return this.running;
    }

    async open(folder: string): Promise<Window> {
        this.current = await this.workbench.open(folder);
        return this.current;
    }

    /**
     * A test with a window, whose final picture is saved. On a busy machine, a workbench may lose a key. So a test that
     * fails is repeated once, in a new window.
     */
    test(name: string, folder: () => string, run: (window: Window) => Promise<void>): void {
        test(name, async () => {
            try {
                await this.attempt(name, folder, run);
            } catch {
                await this.attempt(name, folder, run);
            }
        });
    }

    private async attempt(name: string, folder: () => string, run: (window: Window) => Promise<void>): Promise<void> {
        const window = await this.open(folder());
        try {
            await run(window);
        } catch (error) {
            await window.screenshot(`failed-${name.replaceAll(/\W+/g, "-")}`);
            throw error;
        }
    }
}

/** The sample as the walkthrough writes it, with an error. */
export function sample(change: Readonly<Record<string, (text: string) => string>> = {}): string {
    const folder = path.join(temporaryFolder("sample"), "delivery_robot");
    fs.cpSync(path.join(EXTENSION, "dist/sample"), folder, { recursive: true });
    for (const [name, edit] of Object.entries(change)) {
        const file = path.join(folder, name);
        fs.writeFileSync(file, edit(fs.readFileSync(file, "utf8")));
    }
    return folder;
}

export const MEND = { "nodes/battery.ascxml": (text: string) => text.replace("levle", "level") };
