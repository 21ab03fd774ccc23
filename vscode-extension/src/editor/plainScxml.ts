// SPDX-License-Identifier: Apache-2.0
/** Shows the plain SCXML of a machine beside its source; follows edits, and the caret in both documents. */

import * as vscode from "vscode";
import { plainScxml, type PlainScxml } from "../protocol";
import { lineOf, placeOf } from "./plainPlaces";
import type { LanguageServer } from "./server";

const SCHEME = "as2fm-plain";
const DELAY_MS = 200;

export class PlainScxmlPreview implements vscode.TextDocumentContentProvider, vscode.Disposable {
    private readonly changes = new vscode.EventEmitter<vscode.Uri>();
    readonly onDidChange = this.changes.event;
    private readonly shown = new Map<string, PlainScxml>();
    private readonly subscriptions: vscode.Disposable[];
    private timer: NodeJS.Timeout | undefined;
    /** The place to which this class has moved a caret. The event that results from this is ignored. */
    private moved: { readonly editor: vscode.TextEditor; readonly caret: vscode.Position } | undefined;

    constructor(private readonly server: LanguageServer) {
        this.subscriptions = [
            vscode.workspace.registerTextDocumentContentProvider(SCHEME, this),
            server.onModels(() => {
                this.refreshSoon();
            }),
            vscode.workspace.onDidCloseTextDocument((document) => this.shown.delete(document.uri.toString())),
            vscode.window.onDidChangeTextEditorSelection((event) => {
                this.follow(event);
            }),
        ];
    }

    async open(source: vscode.TextEditor): Promise<void> {
        const uri = previewOf(source.document.uri);
        const document = await vscode.workspace.openTextDocument(uri);
        await vscode.languages.setTextDocumentLanguage(document, "scxml");
        await vscode.window.showTextDocument(document, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true });
        this.sync(source, uri);
    }

    async provideTextDocumentContent(uri: vscode.Uri): Promise<string> {
        const source = sourceOf(uri);
        const translated = await this.server.ask(plainScxml, { textDocument: { uri: source.toString() } });
        if (!translated) return "";
        const before = this.shown.get(uri.toString());
        // While the source has errors, keep the last valid text.
        if (translated.problem && before?.text) return before.text;
        this.shown.set(uri.toString(), translated);
        return translated.problem ? `<!-- ${translated.problem.replaceAll("--", "- -")} -->\n` : translated.text;
    }

    dispose(): void {
        clearTimeout(this.timer);
        this.changes.dispose();
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    private refreshSoon(): void {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => {
            for (const document of vscode.workspace.textDocuments) {
                if (document.uri.scheme === SCHEME) this.changes.fire(document.uri);
            }
        }, DELAY_MS);
    }

    private follow({ textEditor, selections }: vscode.TextEditorSelectionChangeEvent): void {
        const ours = textEditor === this.moved?.editor && selections[0]?.active.isEqual(this.moved.caret);
        this.moved = undefined;
        if (ours) return;
        const { uri } = textEditor.document;
        if (uri.scheme === SCHEME) this.syncBack(textEditor);
        else this.sync(textEditor, previewOf(uri));
    }

    private sync(source: vscode.TextEditor, preview: vscode.Uri): void {
        const shown = this.shown.get(preview.toString());
        const editor = editorOf(preview);
        if (!shown || !editor) return;
        const line = lineOf(shown.lines, source.document.uri.toString(), source.selection.active);
        if (line !== undefined) this.reveal(editor, new vscode.Range(line, 0, line, 0));
    }

    private syncBack(preview: vscode.TextEditor): void {
        const shown = this.shown.get(preview.document.uri.toString());
        const place = shown && placeOf(shown.lines, preview.selection.active.line);
        const editor = place && editorOf(vscode.Uri.parse(place.uri));
        if (!editor) return;
        const { start, end } = place.range;
        this.reveal(editor, new vscode.Range(start.line, start.character, end.line, end.character));
    }

    private reveal(editor: vscode.TextEditor, range: vscode.Range): void {
        if (editor.selection.active.isEqual(range.start)) return;
        this.moved = { editor, caret: range.start };
        editor.selection = new vscode.Selection(range.start, range.start);
        editor.revealRange(range, vscode.TextEditorRevealType.InCenterIfOutsideViewport);
    }
}

function previewOf(source: vscode.Uri): vscode.Uri {
    const name = source.path.replace(/^.*\//, "").replace(/\.\w+$/, "");
    return vscode.Uri.from({ scheme: SCHEME, path: `/${name} (plain).scxml`, query: source.toString() });
}

function sourceOf(preview: vscode.Uri): vscode.Uri {
    return vscode.Uri.parse(preview.query);
}

function editorOf(uri: vscode.Uri): vscode.TextEditor | undefined {
    return vscode.window.visibleTextEditors.find((editor) => editor.document.uri.toString() === uri.toString());
}
