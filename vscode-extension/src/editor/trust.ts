// SPDX-License-Identifier: Apache-2.0
/** What Restricted Mode leaves out: whatever writes files, or starts programs, because of what the workspace holds. */

import * as vscode from "vscode";

/** Whether the workspace is trusted; if not, the user is told why nothing happens and where trust is granted. */
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
