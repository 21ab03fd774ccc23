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
    readonly body?: Partial<Stopped>;
}

/** Where and why a run has stopped. `text` is empty if the reason is enough. */
export interface Stopped {
    readonly reason: string;
    readonly text: string;
    readonly threadId: number;
}

/** A run whose state is shown. */
export interface Run {
    /** Where its adapter is asked while it has stopped. */
    readonly current: Pick<vscode.DebugSession, "configuration" | "customRequest"> | undefined;
    readonly onStopped: vscode.Event<unknown>;
    readonly onEnded: vscode.Event<unknown>;
    /** The answer to a request; errors are shown. */
    request(command: string, options: object): Promise<unknown>;
}

/** The requests after which a run moves until it stops. */
const MOVING = new Set(["continue", "reverseContinue", "next", "stepIn", "stepOut", "stepBack", "goToStep", "restart"]);

/** Tell why a run could not start. The adapter keeps VS Code from showing a dialog that leads to launch.json. */
function tellFailure(reason: string): void {
    const problems = vscode.l10n.t("Show Problems");
    void vscode.window.showErrorMessage(reason, problems).then((pressed) => {
        if (pressed === problems) void vscode.commands.executeCommand("workbench.actions.view.problems");
    });
}

export class DebugSessions implements Run, vscode.Disposable {
    private readonly stopped = new vscode.EventEmitter<vscode.DebugSession>();
    private readonly moving = new vscode.EventEmitter<vscode.DebugSession>();
    private readonly ended = new vscode.EventEmitter<vscode.DebugSession>();
    private readonly registration: vscode.Disposable;
    /** The session that has stopped last. */
    current: vscode.DebugSession | undefined;
    /** Its last stop. */
    stop: Stopped | undefined;

    readonly onStopped = this.stopped.event;
    readonly onMoving = this.moving.event;
    readonly onEnded = this.ended.event;

    constructor() {
        this.registration = vscode.debug.registerDebugAdapterTrackerFactory(DEBUG_TYPE, {
            createDebugAdapterTracker: (session) => ({
                onDidSendMessage: (message: Message) => {
                    if (message.command === "launch" && message.success === false) tellFailure(message.message ?? "");
                    if (message.event !== "stopped") return;
                    this.current = session;
                    this.stop = { reason: "", text: "", threadId: 0, ...message.body };
                    this.stopped.fire(session);
                },
                onWillReceiveMessage: ({ command }: Message) => {
                    if (command !== undefined && MOVING.has(command)) this.moving.fire(session);
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
        for (const part of [this.registration, this.stopped, this.moving, this.ended]) part.dispose();
    }
}
