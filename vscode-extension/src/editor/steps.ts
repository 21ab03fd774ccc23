// SPDX-License-Identifier: Apache-2.0
/** Steps of the walkthrough that are done once something has come of them, not once a command has been called. */

import * as vscode from "vscode";

export type Step = "mended" | "translated" | "verified";

/** For the `completionEvents` of the walkthrough. */
export function done(step: Step): void {
    void vscode.commands.executeCommand("setContext", `as2fm.${step}`, true);
}

/** Notes when models had errors and have none any more. */
export function watchMending(): vscode.Disposable {
    let broken = false;
    return vscode.languages.onDidChangeDiagnostics(() => {
        const found = vscode.languages.getDiagnostics().some(([, diagnostics]) => diagnostics.some(isError));
        if (broken && !found) done("mended");
        broken = found;
    });
}

function isError({ source, severity }: vscode.Diagnostic): boolean {
    return source === "as2fm" && severity === vscode.DiagnosticSeverity.Error;
}
