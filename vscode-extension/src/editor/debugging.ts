// SPDX-License-Identifier: Apache-2.0
/** Debugging runs of a system: the debug type `as2fm`, whose adapter is part of the server's installation. */

import * as vscode from "vscode";
import { safeVariables } from "../server/surroundings";
import type { Documents } from "./documents";
import type { LanguageServer } from "./server";
import { isTrusted } from "./trust";

export const DEBUG_TYPE = "as2fm";

/** The attribute of a run that opens the stage. */
export const ON_STAGE = "onStage";

/** The attribute of a run with the step at which it is shown first. */
export const AT_STEP = "atStep";

/** The attribute of a run that is shown beside another one: a `ComparedWith`. */
export const COMPARED_WITH = "comparedWith";

/** A trace of `verify`. */
export interface Trace {
    readonly seed: number;
    readonly trace: number;
}

export class Debugging implements vscode.DebugConfigurationProvider, vscode.DebugAdapterDescriptorFactory {
    constructor(
        private readonly server: LanguageServer,
        private readonly documents: Documents,
    ) {}

    register(): vscode.Disposable[] {
        return [
            vscode.debug.registerDebugConfigurationProvider(DEBUG_TYPE, this),
            vscode.debug.registerDebugAdapterDescriptorFactory(DEBUG_TYPE, this),
            vscode.languages.registerInlineValuesProvider([{ language: "ascxml" }, { language: "scxml" }], {
                provideInlineValues: inlineValues,
            }),
        ];
    }

    /** Debug a run in which a property does not hold. */
    async counterexample(system: vscode.Uri, property: string, trace: Trace | undefined): Promise<void> {
        await this.start(system, trace ? { property, ...trace, stopOnEntry: false } : { property, against: 1 });
    }

    async start(system: vscode.Uri, attributes: object): Promise<void> {
        if (!isTrusted()) return;
        const folder = vscode.workspace.getWorkspaceFolder(system);
        const name = vscode.workspace.asRelativePath(system);
        const configuration = { type: DEBUG_TYPE, request: "launch", name, program: system.fsPath, ...attributes };
        await vscode.debug.startDebugging(folder, configuration);
    }

    /** Without a launch.json, F5 debugs the model of the active file. */
    async resolveDebugConfiguration(
        _folder: vscode.WorkspaceFolder | undefined,
        given: vscode.DebugConfiguration,
    ): Promise<vscode.DebugConfiguration | undefined> {
        if (!isTrusted() || !(await this.isReady())) return undefined;
        const configuration = { ...given };
        // Without a launch.json, the attributes are missing, although their types do not say so.
        if (!configuration.type) {
            configuration.type = DEBUG_TYPE;
            configuration.request = "launch";
            configuration.name = vscode.l10n.t("Debug system");
        }
        // A run without debugging is a simulation, which is seen on the stage.
        if (configuration["noDebug"])
            Object.assign(configuration, { noDebug: false, stopOnEntry: false, [ON_STAGE]: true });
        if (typeof configuration["program"] === "string") return configuration;
        const program = await this.program(vscode.window.activeTextEditor?.document);
        return program && { ...configuration, program: program.fsPath };
    }

    /** Wait for the server if it is starting; return whether it runs. Otherwise, say so. */
    private async isReady(): Promise<boolean> {
        const states = ["searching", "installing", "starting"];
        if (states.includes(this.server.state.kind))
            await new Promise<void>((resolve) => {
                const waiting = this.server.onState(({ kind }) => {
                    if (states.includes(kind)) return;
                    waiting.dispose();
                    resolve();
                });
            });
        if (this.server.state.kind === "running") return true;
        void vscode.window.showErrorMessage(vscode.l10n.t("The language server is not running."));
        return false;
    }

    /** The model that is debugged from a document: the document itself if it is a JANI model, or a tree that belongs to
     * no system; otherwise its system. */
    async program(document: vscode.TextDocument | undefined): Promise<vscode.Uri | undefined> {
        const { kind, systems } = await this.documents.about(document);
        const isAlone = kind === "model" || (kind === "tree" && systems.length === 0);
        return isAlone ? document?.uri : this.documents.system(document);
    }

    createDebugAdapterDescriptor(): vscode.DebugAdapterDescriptor {
        const { state } = this.server;
        if (state.kind !== "running") throw new Error(vscode.l10n.t("The language server is not running."));
        const { command, args } = state.server;
        // The adapter's Python imports no modules from the workspace.
        return new vscode.DebugAdapterExecutable(command, [...args, "debug"], { env: safeVariables(process.env) });
    }
}

const IDENTIFIER = /(?:\b(?:expr|cond|location)=")([^"]*)"/g;
const NAME = /(?<![\w.'])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*/g;
const RESERVED = new Set(["true", "false", "Math", "amp", "lt", "gt", "quot", "apos"]);

/** The names in the expressions of the lines around the place where the run has stopped. */
function inlineValues(
    document: vscode.TextDocument,
    viewPort: vscode.Range,
    context: vscode.InlineValueContext,
): vscode.InlineValue[] {
    const values: vscode.InlineValue[] = [];
    const last = Math.min(viewPort.end.line, context.stoppedLocation.end.line + LINES_AFTER);
    for (let line = viewPort.start.line; line <= last; line++) {
        const { text } = document.lineAt(line);
        for (const expression of text.matchAll(IDENTIFIER)) {
            const start = expression.index + expression[0].length - 1 - (expression[1] ?? "").length;
            for (const name of (expression[1] ?? "").matchAll(NAME)) {
                if (RESERVED.has(name[0].split(".")[0] ?? "")) continue;
                const from = start + name.index;
                const range = new vscode.Range(line, from, line, from + name[0].length);
                values.push(new vscode.InlineValueEvaluatableExpression(range, name[0]));
            }
        }
    }
    return values;
}

const LINES_AFTER = 3;
