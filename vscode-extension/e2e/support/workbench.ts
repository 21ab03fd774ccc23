// SPDX-License-Identifier: Apache-2.0
/** A VS Code server with the packaged extension, and a browser that shows its workbench. */

import { spawn, execFileSync, type ChildProcess } from "node:child_process";
import * as fs from "node:fs";
import * as net from "node:net";
import * as os from "node:os";
import * as path from "node:path";
import { chromium, type BrowserContext, type Page } from "playwright-core";
import { EXTENSION, ROOT } from "./paths";
import { isShown, TIMEOUT_MS, Window } from "./window";

const VSCODE = path.join(ROOT, ".cache/workbench/node_modules/code-server/lib/vscode");
const MAIN = path.join(VSCODE, "out/server-main.js");

/** The time in ms in which a window usually shows the folders of a workspace. */
const READING_MS = 5000;

export interface Options {
    /** The home folder; a new one if not given. That of an earlier workbench contains what it has installed. */
    readonly home?: string;
    readonly settings?: Readonly<Record<string, unknown>>;
    readonly trustEverything?: boolean;
    /** Replaces the environment variables of the tests. */
    readonly environment?: Readonly<Record<string, string>>;
    /** The folders of further extensions. */
    readonly extensions?: readonly string[];
    /** Whether to omit the packaged extension. */
    readonly bare?: boolean;
}

export class Workbench {
    private page: Page | undefined;

    private constructor(
        readonly home: string,
        readonly port: number,
        private readonly server: ChildProcess,
        private readonly browser: BrowserContext,
    ) {}

    static async start(options: Options = {}): Promise<Workbench> {
        const home = options.home ?? temporaryFolder("home");
        const environment = {
            ...process.env,
            HOME: path.join(home, "user"),
            PATH: [hastyCompiler(), ...pathWithoutServer()].join(":"),
            ...options.environment,
        };
        fs.mkdirSync(environment.HOME, { recursive: true });
        const folders = [
            "--server-data-dir",
            path.join(home, "data"),
            "--extensions-dir",
            path.join(home, "extensions"),
        ];
        const settings = { ...SETTINGS, ...options.settings };
        write(path.join(home, "data/data/Machine/settings.json"), JSON.stringify(settings));
        if (options.home === undefined && options.bare !== true) {
            const install = [
                "--install-extension",
                path.join(EXTENSION, "as2fm.vsix"),
                "--accept-server-license-terms",
            ];
            execFileSync(process.execPath, [MAIN, ...install, ...folders], { stdio: "pipe", env: environment });
        }
        for (const extension of options.extensions ?? []) addExtension(path.join(home, "extensions"), extension);
        const port = await freePort();
        const server = spawn(
            process.execPath,
            [
                MAIN,
                ...["--host", "127.0.0.1", "--port", String(port), "--without-connection-token"],
                ...["--accept-server-license-terms", "--telemetry-level", "off", "--force-disable-user-env"],
                ...folders,
                ...(options.trustEverything === false ? [] : ["--disable-workspace-trust"]),
            ],
            { stdio: ["ignore", "pipe", "pipe"], env: environment, detached: true },
        );
        await listening(server, port);
        // Only a browser with a profile keeps the code of the workbench, which is too large for its memory.
        const browser = await chromium.launchPersistentContext(temporaryFolder("browser"), {
            executablePath: "/usr/bin/chromium",
            args: FLAGS,
            viewport: { width: 1280, height: 760 },
            locale: "en-US",
            reducedMotion: "reduce",
            permissions: ["clipboard-read", "clipboard-write"],
        });
        // The limit is generous, because other work on the machine can make a test slow.
        browser.setDefaultTimeout(TIMEOUT_MS);
        return new Workbench(home, port, server, browser);
    }

    /** Opens a folder, or a file that lists the folders of a workspace. After `leave` or `forget`, the browser knows nothing of earlier folders. */
    async open(folder: string): Promise<Window> {
        if (!this.page) {
            this.page = await this.browser.newPage();
            this.page.on("dialog", (dialog) => void dialog.accept()); // whether to leave a page with changes
        }
        this.page.setDefaultTimeout(TIMEOUT_MS);
        const isFile = folder.endsWith(".code-workspace");
        await this.page.goto(`${this.address}/?${isFile ? "workspace" : "folder"}=${folder}`);
        await this.page.locator(".monaco-workbench").waitFor();
        if (isFile) await readWorkspace(this.page, folder);
        return new Window(this.page, isFile ? path.dirname(folder) : folder);
    }

    /** Leaves the page, so that its extensions end, and removes what it has stored. In the same page, the next folder
     * opens faster. */
    async leave(): Promise<void> {
        if (!this.page) return;
        await this.page.goto(`${this.address}/version`);
        await this.removeStored(this.page);
    }

    /** Closes the page without waiting for it, so that the next folder is opened in a new one. */
    async forget(): Promise<void> {
        const page = this.page;
        this.page = undefined;
        await page?.close();
        const empty = await this.browser.newPage();
        await this.removeStored(empty);
        await empty.close();
    }

    private async removeStored(page: Page): Promise<void> {
        const session = await this.browser.newCDPSession(page);
        const storageTypes = "cookies,indexeddb,local_storage,service_workers,cache_storage"; // not the code
        await session.send("Storage.clearDataForOrigin", { origin: this.address, storageTypes });
        await session.detach();
    }

    private get address(): string {
        return `http://127.0.0.1:${this.port}`;
    }

    async stop(): Promise<void> {
        await this.browser.close();
        const ended = new Promise((resolve) => this.server.once("close", resolve));
        // The process group of the server and the processes that it has started.
        if (this.server.pid !== undefined && this.server.exitCode === null) {
            process.kill(-this.server.pid, "SIGTERM");
            const timer = setTimeout(() => process.kill(-(this.server.pid ?? 0), "SIGKILL"), 5000);
            await ended;
            clearTimeout(timer);
        }
    }
}

/**
 * Waits until a window shows the folders of a workspace. VS Code 1.100 shows none if it has read the file before it has
 * created its workspace. It reads the file again when it is written.
 */
async function readWorkspace(page: Page, file: string): Promise<void> {
    const folder = page.locator('.explorer-folders-view [role="treeitem"]').first();
    const end = Date.now() + TIMEOUT_MS;
    while (!(await isShown(folder, READING_MS))) {
        if (Date.now() > end) throw new Error(`the window shows no folder of ${file}`);
        fs.writeFileSync(file, fs.readFileSync(file));
    }
}

/** The folders of PATH in which there is no server: the tests determine which server is found. */
function pathWithoutServer(): string[] {
    const folders = (process.env["PATH"] ?? "").split(":");
    return folders.filter((folder) => !fs.existsSync(path.join(folder, "as2fm-lsp")));
}

/**
 * A folder for PATH with a C compiler that does not optimize. It compiles the kernel of the model checker, which the
 * extension does after the installation, in a fifth of the time.
 */
function hastyCompiler(): string {
    const folder = temporaryFolder("compiler");
    const linker = "import sysconfig; print((sysconfig.get_config_var('LDSHARED') or 'cc').split()[0])";
    const name = execFileSync("python3", ["-c", linker], { encoding: "utf8" }).trim();
    const compiler = execFileSync("sh", ["-c", `command -v ${name} || echo false`], { encoding: "utf8" }).trim();
    const script = path.join(folder, path.basename(name));
    write(script, `#!/bin/sh\nexec ${compiler} "$@" -O0\n`);
    fs.chmodSync(script, 0o755);
    return folder;
}

const SETTINGS = {
    "workbench.startupEditor": "none",
    "workbench.reduceMotion": "on",
    "workbench.tips.enabled": false,
    "workbench.enableExperiments": false,
    "extensions.ignoreRecommendations": true,
    "update.mode": "none",
    "git.enabled": false,
    "editor.minimap.enabled": false,
    // In a browser, changes would be saved after a second, perhaps while a test restores the files of its folder.
    "files.autoSave": "off",
    "files.simpleDialog.enable": true,
    "security.workspace.trust.banner": "never",
    "terminal.integrated.gpuAcceleration": "off",
};

const FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];

/** Installs an extension: its folder, and its entry in the list. */
function addExtension(extensions: string, folder: string): void {
    const target = path.join(extensions, path.basename(folder));
    fs.cpSync(folder, target, { recursive: true });
    const { name, publisher, version } = JSON.parse(
        fs.readFileSync(path.join(folder, "package.json"), "utf8"),
    ) as Manifest;
    const list = path.join(extensions, "extensions.json");
    const known = fs.existsSync(list) ? (JSON.parse(fs.readFileSync(list, "utf8")) as unknown[]) : [];
    const location = { $mid: 1, path: target, scheme: "file" };
    known.push({
        identifier: { id: `${publisher}.${name}` },
        version,
        location,
        relativeLocation: path.basename(folder),
    });
    fs.writeFileSync(list, JSON.stringify(known));
}

/** The folder of an extension that consists of one script. */
export function fakeExtension(
    publisher: string,
    name: string,
    main: string,
    activationEvents: readonly string[],
): string {
    const version = "0.0.1";
    const folder = path.join(temporaryFolder(name), `${publisher}.${name}-${version}`);
    const manifest = { name, publisher, version, engines: { vscode: "^1.90.0" }, main: "./main.js", activationEvents };
    write(path.join(folder, "package.json"), JSON.stringify(manifest));
    write(path.join(folder, "main.js"), main);
    return folder;
}

interface Manifest {
    readonly name: string;
    readonly publisher: string;
    readonly version: string;
}

const folders: string[] = [];

/** An empty folder that is removed after the tests. */
export function temporaryFolder(name: string): string {
    const folder = fs.realpathSync(fs.mkdtempSync(path.join(os.tmpdir(), `as2fm-${name}-`)));
    if (folders.length === 0) {
        process.once("exit", () => {
            for (const folder of folders) fs.rmSync(folder, { recursive: true, force: true, maxRetries: 3 });
        });
    }
    folders.push(folder);
    return folder;
}

export function write(file: string, text: string | Buffer): void {
    fs.mkdirSync(path.dirname(file), { recursive: true });
    fs.writeFileSync(file, text);
}

function freePort(): Promise<number> {
    return new Promise((resolve, reject) => {
        const server = net.createServer();
        server.once("error", reject);
        server.listen(0, "127.0.0.1", () => {
            const address = server.address();
            server.close(() => {
                if (address !== null && typeof address === "object") resolve(address.port);
                else reject(new Error("no free port"));
            });
        });
    });
}

function listening(server: ChildProcess, port: number): Promise<void> {
    return new Promise((resolve, reject) => {
        let said = "";
        const hear = (chunk: Buffer) => {
            said += chunk.toString();
            if (said.includes(`Extension host agent listening on ${port}`)) resolve();
        };
        server.stdout?.on("data", hear);
        server.stderr?.on("data", hear);
        server.once("error", reject);
        server.once("close", () => {
            reject(new Error(`The VS Code server has ended:\n${said}`));
        });
    });
}
