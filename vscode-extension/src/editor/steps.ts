// SPDX-License-Identifier: Apache-2.0
/** Completes the steps of the walkthrough that depend on the result of a command, not on its call. */

import * as vscode from "vscode";

export type Step = "mended" | "translated" | "verified";

/** Set the context key of a step, to which the `completionEvents` of the walkthrough refer. */
export function done(step: Step): void {
    void vscode.commands.executeCommand("setContext", `as2fm.${step}`, true);
}

/** Completes the step `mended` when models had errors and no longer have any. */
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
