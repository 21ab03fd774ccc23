// SPDX-License-Identifier: Apache-2.0
/**
 * Decides whether the workspace contains models, so that the server is needed.
 *
 * A system file is usually called `main.xml`. VS Code finds a file by its name much faster than by its extension, so
 * systems are found by this name. A behavior tree without a system is an XML file with any name: it is a model once it
 * is opened. Other projects have XML files, too: there, the server is not started.
 */

import * as vscode from "vscode";

const SYSTEM_FILE = "main.xml";
const SYSTEM = /<(roaml|convince_mc_tc)\b/;
const TREE = /<(root\b[^<]*\bBTCPP_format|BehaviorTree\b|TreeNodesModel\b)/;
const LANGUAGES = new Set(["ascxml", "scxml", "jani"]);
const MAX_LINES_TO_ROOT = 200;

export class Activation implements vscode.Disposable {
    private readonly needs = new vscode.EventEmitter<void>();
    private readonly firstNeed = new Promise<void>((resolve) => this.needs.event(resolve));
    private readonly opened = vscode.workspace.onDidOpenTextDocument((document) => {
        if (isModel(document)) this.need();
    });

    dispose(): void {
        this.opened.dispose();
        this.needs.dispose();
    }

    /** Report that the server is needed for another reason than a model, for example for a command. */
    need(): void {
        this.needs.fire();
    }

    /** Resolves as soon as a model exists or is opened, or the server is needed for another reason. */
    async needed(): Promise<void> {
        const { textDocuments, workspaceFolders = [] } = vscode.workspace;
        const texts = await Promise.all(workspaceFolders.map(({ uri }) => systemFile(uri)));
        const named = texts.filter((text) => text !== undefined);
        if (named.some((text) => SYSTEM.test(text)) || textDocuments.some(isModel)) return;
        // Without any XML, the extension was activated by a machine, a command or the debugger.
        if (named.length === 0 && !textDocuments.some(isXml)) return;
        const models = await vscode.workspace.findFiles("**/*.{ascxml,scxml,btproj}", undefined, 1);
        if (models.length === 0) await this.firstNeed;
    }
}

function isModel(document: vscode.TextDocument): boolean {
    if (LANGUAGES.has(document.languageId)) return true;
    const text = isXml(document) ? document.getText(new vscode.Range(0, 0, MAX_LINES_TO_ROOT, 0)) : "";
    return SYSTEM.test(text) || TREE.test(text);
}

function isXml({ languageId }: vscode.TextDocument): boolean {
    return languageId === "xml";
}

async function systemFile(folder: vscode.Uri): Promise<string | undefined> {
    try {
        const bytes = await vscode.workspace.fs.readFile(vscode.Uri.joinPath(folder, SYSTEM_FILE));
        return new TextDecoder().decode(bytes);
    } catch {
        return undefined;
    }
}
