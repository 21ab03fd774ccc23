// SPDX-License-Identifier: Apache-2.0
/** Completes the steps of the walkthrough that depend on the result of a command, not only on its call. */

import * as vscode from "vscode";

export type Step = "fixed" | "mocked" | "translated" | "verified";

/** Set the context key of a step, to which the `completionEvents` of the walkthrough refer. */
export function done(step: Step): void {
    void vscode.commands.executeCommand("setContext", `as2fm.${step}`, true);
}

/** Complete the step `fixed` when models had errors and no longer have any. */
export function watchErrors(): vscode.Disposable {
    let broken = false;
    return vscode.languages.onDidChangeDiagnostics(() => {
        const hasError = vscode.languages.getDiagnostics().some(([, diagnostics]) => diagnostics.some(isError));
        if (broken && !hasError) done("fixed");
        broken = hasError;
    });
}

function isError({ source, severity }: vscode.Diagnostic): boolean {
    return source === "as2fm" && severity === vscode.DiagnosticSeverity.Error;
}
