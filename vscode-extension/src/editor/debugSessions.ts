// SPDX-License-Identifier: Apache-2.0
/** The runs that are debugged: events when one stops or ends, for the views that show its state. */

import * as vscode from "vscode";
import { DEBUG_TYPE } from "./debugging";

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
                onDidSendMessage: (message: { event?: string }) => {
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
