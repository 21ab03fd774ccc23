// SPDX-License-Identifier: Apache-2.0
/** Starts a server and connects the editor to it. */

import { spawn, type ChildProcess } from "node:child_process";
import * as vscode from "vscode";
import {
    CloseAction,
    ErrorAction,
    LanguageClient,
    RevealOutputChannelOn,
    type DocumentSelector,
    type LanguageClientOptions,
} from "vscode-languageclient/node";
import { SHOW_FIRST_ERROR, TRANSLATE, VERIFY, type Translated } from "../protocol";
import { handshake } from "../server/handshake";
import type { Server } from "../server/server";
import type { Exit, Session } from "../server/supervisor";
import { safeFolder, safeVariables } from "../server/surroundings";
import { isTrusted } from "./trust";
import { ownsWellFormedness } from "./xmlExtension";

/**
 * Interface definitions keep the language that another extension assigns to them. JSON is excluded: its documents would
 * have two formatters, and the server reads struct declarations in it from the disk.
 */
const SELECTOR: DocumentSelector = [
    ...["ascxml", "scxml", "jani", "xml"].flatMap((language) => [
        { scheme: "file", language },
        { scheme: "untitled", language },
    ]),
    { scheme: "file", pattern: "**/*.{msg,srv,action}" },
    // Results and pictures of a tree follow its mocks while they are edited.
    { scheme: "file", pattern: "**/*.mocks" },
    // Errors in the configuration, and in the arguments of an experiment, are shown while they are edited.
    { scheme: "file", pattern: "**/{as2fm,pyproject,*.experiment}.toml" },
];

/** The command with which lenses of the server show locations. Its arguments have the types of LSP. */
export const SHOW_REFERENCES = "as2fm.showReferences";

/** The command with which lenses show why a property fails. Arguments: the URI of a system, the name of a property. */
export const EXPERIMENT = "as2fm.experiment";
export const SHOW_COUNTEREXAMPLE = "as2fm.showCounterexample";
export const SHOW_WITNESS = "as2fm.showWitness";
export const SET_EXPECTATION = "as2fm.setExpectation";
export const COMPARE_RUNS = "as2fm.compareRuns";
export const DEBUG_COUNTEREXAMPLE = "as2fm.debugCounterexample";

/** Debugs a system or a tree. Arguments: its URI, and attributes of `launch`. */
export const DEBUG_MODEL = "as2fm.debugModel";

/** Shows a tree with fields for its mocks. Argument: the URI of the tree. */
export const EDIT_MOCKS = "as2fm.editMocks";

const WELL_FORMEDNESS = "xml-syntax";
const MAX_LOGGED_CHARACTERS = 4000;

/** Handles the results of lenses and commands of the server. */
export interface Listener {
    onTranslated(translated: Translated): unknown;
    /** The server knows that a file on the disk has changed. */
    onFile(): void;
    /** Executes a command instead of the server, so that the Test Explorer shows the results. No names means all. */
    onVerify(system: string, names: readonly string[]): unknown;
}

export interface Connection extends Session {
    readonly client: LanguageClient;
}

export async function connect(server: Server, log: vscode.LogOutputChannel, listener: Listener): Promise<Connection> {
    const started = spawn(server.command, [...server.args], {
        stdio: "pipe",
        windowsHide: true,
        cwd: safeFolder(),
        env: { ...process.env, ...safeVariables(process.env) },
    });
    const ended = endOf(started, log);
    const client = new QuietClient(
        "as2fm",
        "AS2FM",
        async () => {
            await spawned(started);
            return started;
        },
        options(log, listener),
    );
    await handshake(client, { ended, kill: () => started.kill() });
    return {
        client,
        ended,
        async stop() {
            try {
                await client.dispose(2000);
            } catch (error) {
                log.debug(`The server did not stop as asked: ${String(error)}`);
            }
            started.kill();
        },
    };
}

/** Hides the error messages of the library: the state of the server shows failures. */
class QuietClient extends LanguageClient {
    override error(message: string, data?: unknown): void {
        super.error(message, data, false);
    }
}

function options(log: vscode.LogOutputChannel, listener: Listener): LanguageClientOptions {
    return {
        documentSelector: SELECTOR,
        diagnosticCollectionName: "as2fm",
        outputChannel: log,
        traceOutputChannel: log,
        revealOutputChannelOn: RevealOutputChannelOn.Never,
        // The server also checks files that are not open, and is notified when they change.
        initializationOptions: {
            diagnostics: "push",
            // The server checks trust again before it writes. It is restarted when trust is granted.
            trusted: vscode.workspace.isTrusted,
            settings: vscode.workspace.getConfiguration("as2fm"),
            showReferences: SHOW_REFERENCES,
            showCounterexample: SHOW_COUNTEREXAMPLE,
            showWitness: SHOW_WITNESS,
            debugCounterexample: DEBUG_COUNTEREXAMPLE,
            debugModel: DEBUG_MODEL,
            editMocks: EDIT_MOCKS,
            experiment: EXPERIMENT,
            setExpectation: SET_EXPECTATION,
            triggerSuggest: "editor.action.triggerSuggest",
        },
        progressOnInitialization: false,
        initializationFailedHandler: () => false,
        // The supervisor decides what happens when the process ends.
        errorHandler: {
            error: () => ({ action: ErrorAction.Continue, handled: true }),
            closed: () => ({ action: CloseAction.DoNotRestart, handled: true }),
        },
        middleware: {
            workspace: {
                async didChangeWatchedFile(event, next) {
                    await next(event);
                    listener.onFile();
                },
            },
            handleDiagnostics(uri, diagnostics, next) {
                next(uri, isXml(uri) && ownsWellFormedness() ? diagnostics.filter(isOurs) : diagnostics);
            },
            async executeCommand(command, args, next) {
                if (command !== SHOW_FIRST_ERROR && !isTrusted()) return undefined;
                if (command === VERIFY && typeof args[0] === "string") {
                    await listener.onVerify(args[0], Array.isArray(args[1]) ? args[1].map(String) : []);
                    return undefined;
                }
                const answer: unknown = await next(command, args);
                if (command === TRANSLATE && isTranslated(answer)) await listener.onTranslated(answer);
                return answer;
            },
        },
    };
}

function isXml(uri: vscode.Uri): boolean {
    const document = vscode.workspace.textDocuments.find((open) => open.uri.toString() === uri.toString());
    return document ? document.languageId === "xml" : uri.path.endsWith(".xml");
}

/** Whether to show a diagnostic: the XML extension reports errors of well-formedness, too. */
function isOurs(diagnostic: vscode.Diagnostic): boolean {
    const code = typeof diagnostic.code === "object" ? diagnostic.code.value : diagnostic.code;
    return code !== WELL_FORMEDNESS;
}

function isTranslated(answer: unknown): answer is Translated {
    return typeof answer === "object" && answer !== null && "uri" in answer && typeof answer.uri === "string";
}

function spawned(process: ChildProcess): Promise<void> {
    return new Promise((resolve, reject) => {
        if (process.pid !== undefined) resolve();
        process.once("error", reject);
    });
}

function endOf(process: ChildProcess, log: vscode.LogOutputChannel): Promise<Exit> {
    let detail = "";
    process.stderr?.setEncoding("utf8").on("data", (text: string) => {
        detail = (detail + text).slice(-MAX_LOGGED_CHARACTERS);
        log.append(text);
    });
    return new Promise((resolve) => {
        process.once("error", (error) => {
            resolve({ status: null, signal: null, detail: error.message });
        });
        process.once("close", (status, signal) => {
            resolve({ status, signal, detail });
        });
    });
}
