// SPDX-License-Identifier: Apache-2.0
/** A read-only view of a JANI file, formatted and with an outline. The file itself is not changed. */

import * as vscode from "vscode";
import { janiView } from "../protocol";
import type { LanguageServer } from "./server";

const SCHEME = "as2fm-jani";

export class JaniView implements vscode.TextDocumentContentProvider, vscode.DocumentSymbolProvider, vscode.Disposable {
    private readonly changes = new vscode.EventEmitter<vscode.Uri>();
    readonly onDidChange = this.changes.event;
    private readonly outlines = new Map<string, vscode.DocumentSymbol[]>();
    private readonly subscriptions: vscode.Disposable[];

    constructor(private readonly server: LanguageServer) {
        const files = vscode.workspace.createFileSystemWatcher("**/*.jani");
        this.subscriptions = [
            files,
            files.onDidChange((uri) => {
                this.refresh(uri);
            }),
            files.onDidCreate((uri) => {
                this.refresh(uri);
            }),
            vscode.workspace.registerTextDocumentContentProvider(SCHEME, this),
            vscode.languages.registerDocumentSymbolProvider({ scheme: SCHEME }, this),
            vscode.workspace.onDidCloseTextDocument(({ uri }) => this.outlines.delete(uri.toString())),
        ];
    }

    async open(file: vscode.Uri, viewColumn: vscode.ViewColumn): Promise<void> {
        const uri = viewOf(file);
        this.refresh(file);
        const document = await vscode.workspace.openTextDocument(uri);
        await vscode.window.showTextDocument(document, { preview: true, viewColumn });
    }

    async provideTextDocumentContent(uri: vscode.Uri): Promise<string> {
        const view = await this.server.ask(janiView, { textDocument: { uri: uri.query } });
        if (!view) return "";
        const convert = this.server.client?.protocol2CodeConverter;
        this.outlines.set(uri.toString(), (await convert?.asDocumentSymbols(view.symbols)) ?? []);
        return view.problem === "" ? view.text : `${view.problem}\n`;
    }

    async provideDocumentSymbols({ uri }: vscode.TextDocument): Promise<vscode.DocumentSymbol[]> {
        // After a reload of the window, the document is open before its content was requested.
        if (!this.outlines.has(uri.toString())) await this.provideTextDocumentContent(uri);
        return this.outlines.get(uri.toString()) ?? [];
    }

    dispose(): void {
        this.changes.dispose();
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    /** Update the view of a file that was written again. */
    private refresh(file: vscode.Uri): void {
        const uri = viewOf(file);
        if (vscode.workspace.textDocuments.some((document) => document.uri.toString() === uri.toString()))
            this.changes.fire(uri);
    }
}

function viewOf(file: vscode.Uri): vscode.Uri {
    const path = file.path.replace(/\.jani$/, " (laid out).jani");
    return vscode.Uri.from({ scheme: SCHEME, path, query: file.toString() });
}
