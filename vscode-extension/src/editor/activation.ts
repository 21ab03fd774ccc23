// SPDX-License-Identifier: Apache-2.0
/**
 * Decides whether the workspace contains models, so that the server is needed.
 *
 * A system file is usually called `main.xml`. VS Code finds a file by its name much faster than by its extension, so
 * only this name activates the extension. Other projects may have such a file, too: there, the server is not started.
 */

import * as vscode from "vscode";

const SYSTEM_FILE = "main.xml";
const SYSTEM = /<(roaml|convince_mc_tc)\b/;
const LANGUAGES = new Set(["ascxml", "scxml", "jani"]);

/** Resolves as soon as a model exists or is opened; immediately if the extension was activated for another reason. */
export async function modelsExist(subscriptions: { dispose(): unknown }[]): Promise<void> {
    const { textDocuments, workspaceFolders = [] } = vscode.workspace;
    const texts = await Promise.all(workspaceFolders.map(({ uri }) => systemFile(uri)));
    const named = texts.filter((text) => text !== undefined);
    if (named.length === 0 || named.some((text) => SYSTEM.test(text)) || textDocuments.some(isModel)) return;
    const machines = await vscode.workspace.findFiles("**/*.{ascxml,scxml}", undefined, 1);
    if (machines.length > 0) return;
    await new Promise<void>((resolve) => {
        const opened = vscode.workspace.onDidOpenTextDocument((document) => {
            if (isModel(document)) resolve();
        });
        subscriptions.push(opened);
    });
}

function isModel({ languageId }: vscode.TextDocument): boolean {
    return LANGUAGES.has(languageId);
}

async function systemFile(folder: vscode.Uri): Promise<string | undefined> {
    try {
        const bytes = await vscode.workspace.fs.readFile(vscode.Uri.joinPath(folder, SYSTEM_FILE));
        return new TextDecoder().decode(bytes);
    } catch {
        return undefined;
    }
}
