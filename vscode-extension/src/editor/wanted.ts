// SPDX-License-Identifier: Apache-2.0
/**
 * Whether there is anything for the server to do.
 *
 * A system file is mostly called `main.xml`. VS Code looks for a file of one name much faster than for all files with an
 * ending, so this name alone activates the extension. Other projects have such a file, too: these are left alone.
 */

import * as vscode from "vscode";

const SYSTEM_FILE = "main.xml";
const SYSTEM = /<(roaml|convince_mc_tc)\b/;
const LANGUAGES = new Set(["ascxml", "scxml", "jani"]);

/** Resolves as soon as there is something to do: at once if more than the name of a file says so. */
export async function wanted(subscriptions: { dispose(): unknown }[]): Promise<void> {
    const { textDocuments, workspaceFolders = [] } = vscode.workspace;
    const found = await Promise.all(workspaceFolders.map(({ uri }) => systemFile(uri)));
    const named = found.filter((text) => text !== undefined);
    if (named.length === 0 || named.some((text) => SYSTEM.test(text)) || textDocuments.some(isOurs)) return;
    const machines = await vscode.workspace.findFiles("**/*.{ascxml,scxml}", undefined, 1);
    if (machines.length > 0) return;
    await new Promise<void>((resolve) => {
        const opened = vscode.workspace.onDidOpenTextDocument((document) => {
            if (isOurs(document)) resolve();
        });
        subscriptions.push(opened);
    });
}

function isOurs({ languageId }: vscode.TextDocument): boolean {
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
