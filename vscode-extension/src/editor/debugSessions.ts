// SPDX-License-Identifier: Apache-2.0
/** The runs that are debugged: events when one stops or ends, for the views that show its state. */

import * as vscode from "vscode";
import { DEBUG_TYPE } from "./debugging";

/** The part of a message of the debug adapter that is used here. */
interface Message {
    readonly event?: string;
    readonly command?: string;
    readonly success?: boolean;
    readonly message?: string;
}

/** Tell why a run could not start. The adapter keeps VS Code from showing a dialog that leads to launch.json. */
function tellFailure(reason: string): void {
    const problems = vscode.l10n.t("Show Problems");
    void vscode.window.showErrorMessage(reason, problems).then((pressed) => {
        if (pressed === problems) void vscode.commands.executeCommand("workbench.actions.view.problems");
    });
}

export class DebugSessions implements vscode.Disposable {
    private readonly stopped = new vscode.EventEmitter<vscode.DebugSession>();
    private readonly ended = new vscode.EventEmitter<vscode.DebugSession>();
    private readonly registration: vscode.Disposable;
    /** The session that has stopped last. */
    current: vscode.DebugSession | undefined;

    readonly onStopped = this.stopped.event;
    readonly onEnded = this.ended.event;

    constructor() {
        this.registration = vscode.debug.registerDebugAdapterTrackerFactory(DEBUG_TYPE, {
            createDebugAdapterTracker: (session) => ({
                onDidSendMessage: (message: Message) => {
                    if (message.command === "launch" && message.success === false) tellFailure(message.message ?? "");
                    if (message.event !== "stopped") return;
                    this.current = session;
                    this.stopped.fire(session);
                },
                onExit: () => {
                    if (this.current === session) this.current = undefined;
                    this.ended.fire(session);
                },
            }),
        });
    }

    /** The answer of the current run to a request; errors are shown. */
    async request(command: string, options: object): Promise<unknown> {
        const session = this.current ?? vscode.debug.activeDebugSession;
        if (session?.type !== DEBUG_TYPE) return undefined;
        try {
            return await session.customRequest(command, options);
        } catch (error) {
            void vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
            return undefined;
        }
    }

    dispose(): void {
        for (const part of [this.registration, this.stopped, this.ended]) part.dispose();
    }
}
