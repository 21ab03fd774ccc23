// SPDX-License-Identifier: Apache-2.0
/** The panels with pictures: one for each kind, which follows the active document and the caret. */

import * as vscode from "vscode";
import type { Activity, FromView, PictureKind } from "../pictures/contract";
import type { Highlight } from "../protocol";
import { PictureSource, titleOf, type ActiveNode } from "./pictureSource";
import type { LanguageServer } from "./server";
import { webviewPage, webviewPanel } from "./webviewPage";

const DELAY_MS = 200;
const LOADING_LIMIT_MS = 10_000;

export class PicturePanels implements vscode.Disposable {
    private readonly panels = new Map<PictureKind, PicturePanel>();
    /** The pictures that follow the text: those of the panels, and those of the stage. */
    private readonly sources = new Set<PictureSource>();
    private readonly subscriptions: vscode.Disposable[];
    private timer: NodeJS.Timeout | undefined;
    private highlights: readonly Highlight[] = [];
    private activeNodes: readonly ActiveNode[] = [];
    private activeEdges: Activity["edges"] = [];
    private readonly verified = new vscode.EventEmitter<undefined>();
    /** A tree was verified after a change of its mocks. */
    readonly onVerified = this.verified.event;
    /** Undoes the last change of the text of a picture, or makes it again. */
    onChangeBack: (source: PictureSource, which: "undo" | "redo") => Promise<void> = () => Promise.resolve();

    constructor(
        private readonly context: vscode.ExtensionContext,
        private readonly server: LanguageServer,
        private readonly log: vscode.LogOutputChannel,
    ) {
        this.subscriptions = [
            server.onModels(() => {
                this.refreshSoon();
            }),
            vscode.workspace.onDidRenameFiles(({ files }) => {
                for (const source of this.sources) source.rename(files);
                this.refreshSoon();
            }),
            vscode.window.onDidChangeTextEditorSelection(({ textEditor }) => {
                this.follow(textEditor);
            }),
            vscode.window.onDidChangeActiveTextEditor((editor) => {
                if (editor) this.follow(editor);
            }),
            vscode.debug.onDidChangeBreakpoints(() => {
                for (const source of this.sources) source.postBreakpoints();
            }),
        ];
    }

    /**
     * Resolves when the page of the picture has loaded. In a browser, the pages of all webviews share a service worker,
     * which each new page replaces. So pages that are opened at the same time can lose their scripts and stay empty.
     */
    async open(kind: PictureKind, uri: vscode.Uri, column = vscode.ViewColumn.Beside): Promise<void> {
        let panel = this.panels.get(kind);
        if (!panel) {
            panel = new PicturePanel(kind, this.context, this.server, this.log, column);
            const { source } = panel;
            this.add(source);
            this.panels.set(kind, panel);
            panel.onDispose(() => {
                this.panels.delete(kind);
                this.remove(source);
            });
        }
        await panel.show(uri);
        await panel.loaded;
    }

    /** Let a picture follow the text and the run. */
    add(source: PictureSource): void {
        source.showActivity(this.activeNodes, this.activeEdges);
        source.highlighted = this.highlights.find((highlight) => highlight.kind === source.kind);
        source.onVerified = () => {
            this.verified.fire(undefined);
        };
        source.onChangeBack = (which) => this.onChangeBack(source, which);
        this.sources.add(source);
    }

    remove(source: PictureSource): void {
        this.sources.delete(source);
    }

    /** Show a tree with fields for its mocks. */
    async editMocks(uri: vscode.Uri): Promise<void> {
        await this.open("tree", uri);
        await this.panels.get("tree")?.source.showMocks(true);
    }

    /** The document whose picture of a kind is shown. */
    uriOf(kind: PictureKind): vscode.Uri | undefined {
        return this.panels.get(kind)?.source.uri;
    }

    /** Highlight nodes in all open pictures and in those that are opened later. Earlier highlights are removed. */
    async highlight(highlights: readonly Highlight[]): Promise<void> {
        this.highlights = highlights;
        for (const source of this.sources)
            await source.highlight(highlights.find((highlight) => highlight.kind === source.kind));
    }

    /** Show the activity of a run in all open pictures and in those that are opened later. It replaces earlier activity. */
    showActivity(nodes: readonly ActiveNode[], edges: Activity["edges"]): void {
        this.activeNodes = nodes;
        this.activeEdges = edges;
        for (const source of this.sources) source.showActivity(nodes, edges);
    }

    dispose(): void {
        clearTimeout(this.timer);
        for (const disposable of [...this.subscriptions, this.verified, ...this.panels.values()]) disposable.dispose();
    }

    /** Show the coverage of new results in the pictures that show coverage. */
    refreshCoverage(): void {
        for (const source of this.sources) void source.showCoverage();
    }

    private refreshSoon(): void {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => {
            for (const source of this.sources) void source.refresh();
        }, DELAY_MS);
    }

    private follow(editor: vscode.TextEditor): void {
        if (!vscode.workspace.getConfiguration("as2fm").get<boolean>("pictures.followCursor", true)) return;
        for (const source of this.sources) source.follow(editor);
    }
}

/** A panel with one picture. */
class PicturePanel implements vscode.Disposable {
    private readonly panel: vscode.WebviewPanel;
    readonly source: PictureSource;
    /** Resolves when the page can draw, or after `LOADING_LIMIT_MS`. */
    readonly loaded: Promise<void>;

    constructor(
        kind: PictureKind,
        context: vscode.ExtensionContext,
        server: LanguageServer,
        log: vscode.LogOutputChannel,
        viewColumn: vscode.ViewColumn,
    ) {
        const dist = vscode.Uri.joinPath(context.extensionUri, "dist");
        const column = { viewColumn, preserveFocus: true };
        this.panel = webviewPanel(context, dist, `as2fm.${kind}`, titleOf(kind), column);
        const { panel } = this;
        this.source = new PictureSource(kind, server, log, {
            post: (message) => void panel.webview.postMessage(message),
            setTitle: (title) => (panel.title = title),
            focus: () => {
                panel.reveal();
            },
        });
        this.loaded = new Promise((resolve) => {
            setTimeout(resolve, LOADING_LIMIT_MS);
            panel.webview.onDidReceiveMessage((message: FromView) => {
                if (message.type === "ready") resolve();
                void this.source.receive(message);
            });
        });
        panel.webview.html = webviewPage(panel.webview, dist, "view.js", ["view.css"]);
    }

    onDispose(listener: () => void): void {
        this.panel.onDidDispose(listener);
    }

    async show(uri: vscode.Uri): Promise<void> {
        this.panel.reveal(undefined, true);
        await this.source.show(uri);
    }

    dispose(): void {
        this.panel.dispose();
    }
}
