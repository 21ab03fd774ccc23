// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { setTimeout as wait } from "node:timers/promises";
import { after, before, test } from "node:test";
import { inspect, isDeepStrictEqual } from "node:util";
import { FIRST_TIMEOUT_MS, INSTALLATION_TIMEOUT_MS, TIMEOUT_MS, type Window } from "./window";
import { EXTENSION, ROOT } from "./paths";
import { temporaryFolder, Workbench, write, type Options } from "./workbench";

/** The time limit for compiling the kernel, in ms. It only prevents an endless wait. */
const KERNEL_TIMEOUT_MS = 600_000;

/**
 * A folder for consecutive tests, which are then done in the same page, because a page takes longer to open than most
 * tests. Each of them starts with the same files, without open editors, views of the panel, and notifications.
 */
export class SharedFolder {
    constructor(readonly make: () => string) {}
}

/** A page that the next test with the same folder uses again. */
interface SharedPage {
    readonly folder: SharedFolder;
    readonly window: Window;
    readonly files: ReadonlyMap<string, Buffer>;
}

/** A workbench that the groups of tests share. Its home folder contains the server's environment. */
export class Stage {
    private running: Workbench | undefined;
    private options: Options = {};
    private shared: SharedPage | undefined;
    home: string | undefined;

    constructor() {
        after(async () => {
            await this.running?.stop();
        });
    }

    /**
     * Prepares the workbench for a group of tests. It is started again only if the group needs different options.
     * Unless the group tests the installation, the server is installed and its kernel compiled, so that each test can
     * run alone.
     */
    use(options: Options = {}, { installs = true } = {}): void {
        before(async () => {
            if (installs && !(this.home !== undefined && hasKernel(this.home))) await this.install();
            await this.start(options);
        });
        after(async () => {
            await this.leave();
        });
    }

    private async leave(): Promise<void> {
        this.shared = undefined;
        await this.running?.leave();
    }

    private async start(options: Options): Promise<void> {
        if (this.running && isDeepStrictEqual(options, this.options)) return;
        await this.running?.stop();
        this.options = options;
        this.running = await Workbench.start({
            ...(this.home === undefined ? {} : { home: this.home }),
            ...options,
        });
        this.home = this.running.home;
    }

    private async install(): Promise<void> {
        await this.start({});
        const window = await this.workbench.open(sample());
        await window.openFile("battery.ascxml");
        const missing = window.statusItem("AS2FM: not installed");
        await missing.or(window.squiggles).first().waitFor();
        if (await missing.isVisible()) await window.acceptInstallation();
        await window.running(INSTALLATION_TIMEOUT_MS);
        await kernel(this.workbench.home);
        await this.workbench.leave();
    }

    get workbench(): Workbench {
        if (!this.running) throw new Error("no workbench runs");
        return this.running;
    }

    /**
     * A test with a window. On a busy machine, a workbench may lose a key. So a test that fails is repeated once, in a
     * new page and with more time for each wait.
     */
    test(name: string, folder: SharedFolder | (() => string), run: (window: Window) => Promise<void>): void {
        test(name, async () => {
            try {
                await this.attempt(name, folder, run, FIRST_TIMEOUT_MS);
            } catch (error) {
                console.log(`the first attempt of "${name}" failed: ${inspect(error)}`);
                await this.attempt(name, folder, run, TIMEOUT_MS);
            }
        });
    }

    private async attempt(
        name: string,
        folder: SharedFolder | (() => string),
        run: (window: Window) => Promise<void>,
        timeout: number,
    ): Promise<void> {
        let window: Window | undefined;
        try {
            window = await this.open(folder);
            window.limit(timeout);
            await run(window);
        } catch (error) {
            await window?.screenshot(`failed-${name.replaceAll(/\W+/g, "-")}`);
            this.shared = undefined;
            await this.workbench.forget();
            throw error;
        }
    }

    private async open(folder: SharedFolder | (() => string)): Promise<Window> {
        if (this.shared?.folder === folder) {
            await this.shared.window.closeAll();
            restore(this.shared.window.folder, this.shared.files);
            return this.shared.window;
        }
        await this.leave();
        if (!(folder instanceof SharedFolder)) return await this.workbench.open(folder());
        const place = folder.make();
        this.shared = { folder, window: await this.workbench.open(place), files: contents(place) };
        return this.shared.window;
    }
}

/** Waits until the kernel of the model checker has been compiled or its compilation has failed. */
export async function kernel(home: string): Promise<void> {
    const limit = Date.now() + KERNEL_TIMEOUT_MS;
    while (!hasKernel(home)) {
        assert.ok(Date.now() < limit, "the kernel has not been compiled");
        await wait(200);
    }
}

function hasKernel(home: string): boolean {
    const environments = path.join(home, "data/data/User/globalStorage/as2fm-lsp.as2fm/environments");
    if (!fs.existsSync(environments)) return false;
    return fs.readdirSync(environments).some((name) => fs.existsSync(path.join(environments, name, "kernel.json")));
}

/** The files of a folder, by their paths in it. */
function contents(folder: string): Map<string, Buffer> {
    const names = fs.readdirSync(folder, { recursive: true, encoding: "utf8" });
    const files = names.filter((name) => fs.statSync(path.join(folder, name)).isFile());
    return new Map(files.map((name) => [name, fs.readFileSync(path.join(folder, name))]));
}

/** Gives the files of a folder the contents that they had, and removes all others. */
function restore(folder: string, files: ReadonlyMap<string, Buffer>): void {
    for (const [name, now] of contents(folder)) {
        const before = files.get(name);
        if (before === undefined) fs.rmSync(path.join(folder, name));
        else if (!now.equals(before)) fs.writeFileSync(path.join(folder, name), before);
    }
    for (const [name, before] of files) {
        if (!fs.existsSync(path.join(folder, name))) write(path.join(folder, name), before);
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

/** Three robots, each in a namespace. */
export function fleet(): string {
    const folder = temporaryFolder("fleet");
    fs.cpSync(path.join(ROOT, "examples/fleet"), folder, { recursive: true });
    return folder;
}
