// SPDX-License-Identifier: Apache-2.0
/** Why a run has stopped, at the line that caused it: the sentence of a property, and the values that it has read. */

import * as vscode from "vscode";
import type { DebugSessions, Stopped } from "./debugSessions";

/** The reasons for a stop that a line explains. `exception` is shown by VS Code. */
const EXPLAINED = new Set(["violated", "satisfied", "failure"]);

/** The part of the answer to `stackTrace` that is used here. */
interface Stack {
    readonly stackFrames: readonly { readonly source?: { readonly path: string }; readonly line: number }[];
}

/** A line, and what is shown there: what has happened, and details. */
interface Reason {
    readonly path: string;
    readonly line: number;
    readonly what: string;
    readonly details: readonly string[];
    readonly isGood: boolean;
}

export class StopReasons implements vscode.Disposable, vscode.CodeLensProvider {
    private readonly changed = new vscode.EventEmitter<void>();
    private readonly bad = frame("debugExceptionWidget.border");
    private readonly good = frame("inputValidation.infoBorder");
    private readonly subscriptions: { dispose(): unknown }[];
    private reason: Reason | undefined;

    readonly onDidChangeCodeLenses = this.changed.event;

    constructor(
        private readonly sessions: DebugSessions,
        private readonly log: vscode.LogOutputChannel,
    ) {
        const languages = ["ascxml", "scxml", "xml", "jani"].map((language) => ({ language, scheme: "file" }));
        this.subscriptions = [
            this.changed,
            this.bad,
            this.good,
            vscode.languages.registerCodeLensProvider(languages, this),
            vscode.window.onDidChangeVisibleTextEditors(() => {
                this.decorate();
            }),
            sessions.onStopped((session) => void this.update(session)),
            sessions.onMoving(() => {
                this.show(undefined);
            }),
            sessions.onEnded(() => {
                this.show(undefined);
            }),
        ];
    }

    /** The sentence is above the line, and the values are below it, because the ends of long lines are not visible. */
    provideCodeLenses(document: vscode.TextDocument): vscode.CodeLens[] {
        const { reason } = this;
        if (reason === undefined || !isIn(document, reason)) return [];
        const [sentence, ...values] = reason.details;
        const icon = reason.isGood ? "$(pass)" : "$(error)";
        const above = lens(reason.line, `${icon}\u00a0${[reason.what, sentence].filter(Boolean).join(": ")}`);
        const below = values.map((value) => lens(reason.line + 1, value.replaceAll("`", "")));
        return reason.line + 1 < document.lineCount ? [above, ...below] : [above];
    }

    dispose(): void {
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    private async update(session: vscode.DebugSession): Promise<void> {
        const { stop } = this.sessions;
        if (stop === undefined || !EXPLAINED.has(stop.reason)) {
            this.show(undefined);
            return;
        }
        try {
            const first = { threadId: stop.threadId, startFrame: 0, levels: 1 };
            const { stackFrames } = (await session.customRequest("stackTrace", first)) as Stack;
            if (this.sessions.stop === stop) this.show(reasonOf(stop, stackFrames));
        } catch (error) {
            this.log.debug(`no place of a stop: ${String(error)}`);
        }
    }

    private show(reason: Reason | undefined): void {
        if (reason === this.reason) return;
        this.reason = reason;
        this.decorate();
        this.changed.fire();
    }

    private decorate(): void {
        for (const editor of vscode.window.visibleTextEditors) {
            const { reason } = this;
            const own = reason !== undefined && isIn(editor.document, reason) ? optionsOf(reason) : [];
            editor.setDecorations(this.bad, reason?.isGood === false ? own : []);
            editor.setDecorations(this.good, reason?.isGood === true ? own : []);
        }
    }
}

function reasonOf({ reason, text }: Stopped, frames: Stack["stackFrames"]): Reason | undefined {
    const [frame] = frames;
    if (frame?.source === undefined) return undefined;
    const [what = "", ...details] = text.split("\n");
    const capitalised = what.charAt(0).toUpperCase() + what.slice(1);
    return {
        path: pathOf(frame.source.path),
        line: frame.line - 1,
        what: capitalised,
        details,
        isGood: reason === "satisfied",
    };
}

/** The path of a URI in which VS Code returns it: on a remote machine, it replaces paths in answers by URIs. */
function pathOf(path: string): string {
    return (path.includes("://") ? vscode.Uri.parse(path) : vscode.Uri.file(path)).path;
}

function isIn(document: vscode.TextDocument, { path }: Reason): boolean {
    return document.uri.path === path;
}

function lens(line: number, title: string): vscode.CodeLens {
    return new vscode.CodeLens(new vscode.Range(line, 0, line, 0), { title, command: "" });
}

function optionsOf({ line, what, details }: Reason): vscode.DecorationOptions[] {
    const hoverMessage = [what, ...details].map((text) => new vscode.MarkdownString().appendText(text));
    return [{ range: new vscode.Range(line, 0, line, 0), hoverMessage }];
}

/** A frame around a line, in a color of a widget of VS Code, which all themes define. */
function frame(widget: "debugExceptionWidget.border" | "inputValidation.infoBorder"): vscode.TextEditorDecorationType {
    const color = new vscode.ThemeColor(widget);
    return vscode.window.createTextEditorDecorationType({
        isWholeLine: true,
        border: "1px solid",
        borderColor: color,
        overviewRulerColor: color,
        overviewRulerLane: vscode.OverviewRulerLane.Full,
    });
}
