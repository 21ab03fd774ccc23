// SPDX-License-Identifier: Apache-2.0
import * as vscode from "vscode";
import type { State } from "../server/supervisor";
import { tellState, type Action } from "./wording";

/** Shows the state of the server in the status bar and beside the language, and each failure once as a message. */
export class StatusItem implements vscode.Disposable {
    private readonly item: vscode.StatusBarItem;
    private actions: readonly Action[] = [];
    private told = "";
    private long = "";

    constructor(private readonly log: vscode.LogOutputChannel) {
        this.item = vscode.window.createStatusBarItem("as2fm.status", vscode.StatusBarAlignment.Right, 90);
        this.item.name = "AS2FM";
        this.item.command = "as2fm.showStatus";
    }

    show(state: State): void {
        const { severity, short, long, actions } = tellState(state);
        const busy = state.kind === "searching" || state.kind === "installing" || state.kind === "starting";
        const icon = busy ? "$(loading~spin) " : severity === "quiet" ? "" : "$(warning) ";
        this.item.text = `${icon}AS2FM: ${short}`;
        this.item.tooltip = long;
        this.item.accessibilityInformation = { label: `AS2FM: ${short}. ${long}`, role: "button" };
        this.item.backgroundColor =
            severity === "quiet" ? undefined : new vscode.ThemeColor(`statusBarItem.${severity}Background`);
        this.item.show();
        this.actions = actions;
        this.long = long;
        this.log.info(long);
        if (state.kind === "failed") {
            if ("detail" in state.failure) this.log.error(state.failure.detail);
            this.tell(severity === "error", long, actions);
        } else {
            this.told = "";
        }
    }

    /** The actions that are available in the current state. */
    async choose(): Promise<void> {
        const picked = await vscode.window.showQuickPick(
            this.actions.map((action) => ({ label: action.title, action })),
            { title: "AS2FM", placeHolder: this.long },
        );
        if (picked) await vscode.commands.executeCommand(picked.action.command);
    }

    dispose(): void {
        this.item.dispose();
    }

    private tell(isError: boolean, long: string, actions: readonly Action[]): void {
        if (this.told === long) return;
        this.told = long;
        const titles = actions.map((action) => action.title);
        const show = isError ? vscode.window.showErrorMessage : vscode.window.showInformationMessage;
        void show(long, ...titles).then((title) => {
            const action = actions.find((candidate) => candidate.title === title);
            if (action) return vscode.commands.executeCommand(action.command);
            return undefined;
        });
    }
}
