// SPDX-License-Identifier: Apache-2.0
/** In Restricted Mode, everything is disabled that writes files, or starts programs depending on the workspace. */

import * as vscode from "vscode";

/** Whether the workspace is trusted. If not, a message states that the action is disabled, and how to grant trust. */
export function isTrusted(): boolean {
    if (!vscode.workspace.isTrusted) void tellRestricted();
    return vscode.workspace.isTrusted;
}

async function tellRestricted(): Promise<void> {
    const manage = vscode.l10n.t("Manage Workspace Trust");
    const text = vscode.l10n.t(
        "This is disabled in Restricted Mode, because it would write files or run programs from the workspace.",
    );
    if ((await vscode.window.showWarningMessage(text, manage)) === manage) {
        await vscode.commands.executeCommand("workbench.trust.manage");
    }
}
