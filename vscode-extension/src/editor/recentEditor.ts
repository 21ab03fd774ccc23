// SPDX-License-Identifier: Apache-2.0
/** The text editor that was used last. VS Code knows none while a picture or a view has the focus. */

import * as vscode from "vscode";

let recent: vscode.TextEditor | undefined;

/** Remember the editor that is used last, from now on. */
export function watchEditors(): vscode.Disposable {
    recent = vscode.window.activeTextEditor;
    return vscode.window.onDidChangeActiveTextEditor((editor) => {
        if (editor) recent = editor;
    });
}

/** The column in which a file is shown: where it is shown already, otherwise that of another text; the one used last. */
export function columnFor(uri: vscode.Uri): vscode.ViewColumn {
    const editors = [...vscode.window.visibleTextEditors].sort(
        (one, other) => Number(other === recent) - Number(one === recent),
    );
    const shown = editors.find((editor) => editor.document.uri.toString() === uri.toString());
    return (shown ?? editors[0])?.viewColumn ?? vscode.ViewColumn.One;
}
