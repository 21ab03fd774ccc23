// SPDX-License-Identifier: Apache-2.0
import * as fs from "node:fs";
import * as path from "node:path";
import { after, afterEach, before, test } from "node:test";
import { isDeepStrictEqual } from "node:util";
import type { Window } from "./window";
import { EXTENSION } from "./paths";
import { temporaryFolder, Workbench, type Options } from "./workbench";

/** A workbench that the groups of tests share, with the server's environment that the first group has created. */
export class Stage {
    private running: Workbench | undefined;
    private options: Options = {};
    home: string | undefined;

    constructor() {
        after(async () => {
            await this.running?.stop();
        });
    }

    /** Prepares the workbench for a group of tests. It is started again only if the group needs different options. */
    use(options: Options = {}): void {
        before(async () => {
            if (this.running && isDeepStrictEqual(options, this.options)) return;
            await this.running?.stop();
            this.options = options;
            this.running = await Workbench.start({
                ...(this.home === undefined ? {} : { home: this.home }),
                ...options,
            });
            this.home = this.running.home;
        });
        afterEach(async () => {
            await this.running?.leave();
        });
    }

    get workbench(): Workbench {
        if (!this.running) throw new Error("no workbench runs");
        return this.running;
    }

    /**
     * A test with a window, whose final picture is saved. On a busy machine, a workbench may lose a key. So a test that
     * fails is repeated once, in a new page.
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
        const window = await this.workbench.open(folder());
        try {
            await run(window);
        } catch (error) {
            await window.screenshot(`failed-${name.replaceAll(/\W+/g, "-")}`);
            await this.workbench.forget();
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
