// SPDX-License-Identifier: Apache-2.0
/** The server of a window: implements the ports of the supervisor in VS Code. */

import { createHash } from "node:crypto";
import * as fs from "node:fs";
import * as os from "node:os";
import { join } from "node:path";
import * as vscode from "vscode";
import type { LanguageClient } from "vscode-languageclient/node";
import { DidChangeConfigurationNotification, type RequestType } from "vscode-languageserver-protocol";
import { PrivateEnvironment, type Step } from "../server/environment";
import { expanded, findServer } from "../server/find";
import { thisHost } from "../server/host";
import { Recall } from "../server/recall";
import { isFailure, type Failure, type Server } from "../server/server";
import { Supervisor, type State } from "../server/supervisor";
import { connect, type Connection, type Listener } from "./client";
import { activeInterpreters } from "./pythonExtensions";
import { tellStep } from "./wording";

/** The time limit for the answers of other extensions. */
const TIMEOUT_MS = 5000;

export class LanguageServer implements vscode.Disposable {
    private readonly supervisor: Supervisor;
    private readonly environment: PrivateEnvironment;
    private readonly recall: Recall;
    private readonly wheel: string;
    private readonly states = new vscode.EventEmitter<State>();
    private readonly models = new vscode.EventEmitter<undefined>();
    private readonly subscriptions: readonly vscode.Disposable[];
    private compiling: Promise<void> | undefined;
    private connection: Connection | undefined;

    /** Fires at each change of the state. */
    readonly onState = this.states.event;
    /**
     * Fires when answers of the server may have changed: after changes of texts, of files on the disk, of folders and of
     * settings, and when a server runs. It may fire often, and before the server is told.
     */
    readonly onModels = this.models.event;

    constructor(
        context: vscode.ExtensionContext,
        private readonly log: vscode.LogOutputChannel,
        listener: Omit<Listener, "onFile">,
    ) {
        const changed = () => {
            this.models.fire(undefined);
        };
        this.subscriptions = [
            vscode.workspace.onDidChangeTextDocument(({ document }) => {
                if (document.uri.scheme === "file" || document.isUntitled) changed();
            }),
            // Without an editor, the text is that on the disk again.
            vscode.workspace.onDidCloseTextDocument(({ uri }) => {
                if (uri.scheme === "file") changed();
            }),
            vscode.workspace.onDidChangeWorkspaceFolders(changed),
            this.onState(({ kind }) => {
                if (kind === "running") changed();
            }),
        ];
        const wheel = findWheel(context.extensionPath);
        const folder = join(context.globalStorageUri.fsPath, "environments");
        this.wheel = wheel.id;
        this.recall = new Recall(context.workspaceState);
        this.environment = new PrivateEnvironment(thisHost, folder, wheel.file, wheel.requirements, wheel.id);
        this.supervisor = new Supervisor({
            find: (hurry) => this.find(hurry),
            install: (onStep) => this.installWithProgress(onStep),
            launch: async (server) => {
                this.connection = await connect(server, log, { ...listener, onFile: changed });
                return this.connection;
            },
            now: Date.now,
            changed: (state) => {
                if (state.kind === "running") void this.recall.keep(this.searchSettings(), state.server);
                else this.connection = undefined;
                void vscode.commands.executeCommand("setContext", "as2fm.running", state.kind === "running");
                this.states.fire(state);
            },
            restarted: (exit) => {
                log.warn(
                    `The server ended with ${exit.signal ?? `status ${exit.status ?? "unknown"}`} and was restarted.`,
                );
                void tellRestarted();
            },
        });
    }

    get state(): State {
        return this.supervisor.state;
    }

    /** The client of the running server. */
    get client(): LanguageClient | undefined {
        return this.connection?.client;
    }

    /** Start the server of a new window. The server that ran last is started before the search ends. */
    open(): Promise<void> {
        const recalled = this.recall.server(this.searchSettings());
        const expected = vscode.workspace.isTrusted || recalled?.origin === "private" ? recalled : undefined;
        return expected ? this.supervisor.expect(expected) : this.supervisor.start();
    }

    start(): Promise<void> {
        return this.supervisor.start();
    }

    /** Search again after a change of settings or interpreters. A running server continues if the search returns it. */
    look(): Promise<void> {
        return this.supervisor.look();
    }

    install(): Promise<void> {
        return this.supervisor.install();
    }

    stop(): Promise<void> {
        return this.supervisor.stop();
    }

    /** Notify the server, which then requests the settings. */
    settingsChanged(): void {
        void this.client?.sendNotification(DidChangeConfigurationNotification.type, { settings: null });
        this.models.fire(undefined);
    }

    /** Send a request; return undefined if no server runs, or if the server returns no result. */
    async ask<P, R>(type: RequestType<P, R, void>, params: P): Promise<R | undefined> {
        try {
            return await this.client?.sendRequest(type, params);
        } catch (error) {
            this.log.debug(`${type.method} has no answer: ${String(error)}`);
            return undefined;
        }
    }

    dispose(): void {
        for (const disposable of [...this.subscriptions, this.states, this.models]) disposable.dispose();
        void this.supervisor.stop();
    }

    /** The settings on which the search depends. Other extensions and installed programs are not included. */
    private searchSettings(): readonly unknown[] {
        return [path("server.path"), path("interpreter"), vscode.workspace.isTrusted, this.wheel];
    }

    private async find(hurry: boolean): Promise<Server | Failure> {
        const trusted = vscode.workspace.isTrusted;
        const [server, interpreter] = [path("server.path"), path("interpreter")];
        const active = trusted && server === "" && interpreter === "" ? await this.active(hurry) : [];
        const outcome = await findServer(thisHost, { server, interpreter, active, trusted }, this.environment);
        const usable = isFailure(outcome) && outcome.kind === "no-server" ? await this.renewed(outcome) : outcome;
        if (!isFailure(usable) && usable.origin === "private") this.compileKernel();
        return usable;
    }

    /** Compile the kernel in the background. A running server uses the compiled kernel from its next verification on. */
    private compileKernel(): void {
        const onOutput = (text: string) => {
            this.log.append(text);
        };
        this.compiling ??= this.environment.compile(onOutput).finally(() => (this.compiling = undefined));
    }

    private active(hurry: boolean): Promise<readonly string[]> {
        const asked = activeInterpreters(this.log);
        if (!hurry) return asked;
        // An extension that does not answer must not prevent the start of the server.
        const late = new Promise<readonly string[]>((resolve) => {
            setTimeout(() => {
                resolve([]);
            }, TIMEOUT_MS);
        });
        return Promise.race([asked, late]);
    }

    /** If an earlier version is installed, install the new one without asking. If that fails, use the earlier one. */
    private async renewed(failure: Failure): Promise<Server | Failure> {
        const older = await this.environment.older();
        if (older === undefined) return failure;
        const renewed = await this.installWithProgress(() => undefined);
        if (!isFailure(renewed)) return renewed;
        this.log.warn("The server of an earlier version is used: the new one could not be installed.");
        if ("detail" in renewed) this.log.warn(renewed.detail);
        return older;
    }

    private async installWithProgress(onStep: (step: Step) => void): Promise<Server | Failure> {
        const interpreter = path("interpreter");
        const active = vscode.workspace.isTrusted ? await this.active(true) : [];
        const preferred = interpreter === "" ? active : [interpreter];
        const options = { location: vscode.ProgressLocation.Notification, cancellable: true, title: "AS2FM" };
        const onOutput = (text: string) => {
            this.log.append(text);
        };
        const installed = await vscode.window.withProgress(options, (progress, token) => {
            const abort = new AbortController();
            token.onCancellationRequested(() => {
                abort.abort();
            });
            return this.environment.install(preferred, {
                signal: abort.signal,
                onOutput,
                avoid: untrustedFolders(),
                onStep: (step) => {
                    progress.report({ message: tellStep(step) });
                    onStep(step);
                },
            });
        });
        if (!isFailure(installed)) this.compileKernel();
        return installed;
    }
}

/** The folders from which no program is started. */
export function untrustedFolders(): string[] {
    if (vscode.workspace.isTrusted) return [];
    return (vscode.workspace.workspaceFolders ?? []).map(({ uri }) => uri.fsPath);
}

/** A setting with the path of a program; empty if not set. */
function path(setting: string): string {
    const written = vscode.workspace.getConfiguration("as2fm").get<string>(setting, "");
    return expanded(written, os.homedir(), vscode.workspace.workspaceFolders?.[0]?.uri.fsPath);
}

async function tellRestarted(): Promise<void> {
    const log = vscode.l10n.t("Show Log");
    const text = vscode.l10n.t("The language server ended unexpectedly and was restarted.");
    if ((await vscode.window.showWarningMessage(text, log)) === log) {
        await vscode.commands.executeCommand("as2fm.showLog");
    }
}

/** The wheel in the extension, the packages that it needs, and an id that changes with their content. */
function findWheel(extension: string): { file: string; requirements: string; id: string } {
    const folder = join(extension, "dist", "wheel");
    const name = fs.readdirSync(folder).find((file) => file.endsWith(".whl"));
    if (name === undefined) throw new Error(`${folder} holds no wheel`);
    const file = join(folder, name);
    const requirements = join(extension, "dist", "requirements.txt");
    const hash = createHash("sha256").update(fs.readFileSync(file)).update(fs.readFileSync(requirements));
    const digest = hash.digest("hex").slice(0, 12);
    return { file, requirements, id: `${name.split("-")[1] ?? "server"}-${digest}` };
}
