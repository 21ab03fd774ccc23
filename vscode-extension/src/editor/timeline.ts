// SPDX-License-Identifier: Apache-2.0
/** The view with the timeline of the run that is debugged. */

import * as path from "node:path";
import * as vscode from "vscode";
import type { FromTimeline, Tile, TileRequest, TimelineWords, ToTimeline } from "../timeline/contract";
import type { DebugSessions, Run } from "./debugSessions";
import { webviewPage } from "./webviewPage";

const VIEW = "as2fm.timeline";

/** What a timeline shows, and what happens when the user acts in it; independent of the page that draws it. */
export class TimelineSource implements vscode.Disposable {
    private readonly subscriptions: vscode.Disposable[];

    constructor(
        private readonly sessions: Run,
        private readonly post: (message: ToTimeline) => void,
    ) {
        this.subscriptions = [
            sessions.onStopped(() => {
                post({ type: "stopped" });
            }),
            sessions.onEnded(() => {
                post({ type: "ended" });
            }),
        ];
    }

    dispose(): void {
        for (const part of this.subscriptions) part.dispose();
    }

    async receive(message: FromTimeline): Promise<void> {
        switch (message.type) {
            case "ready":
                this.post({ type: "words", words: words() });
                this.post({ type: this.sessions.current ? "stopped" : "ended" });
                break;
            case "ask":
                this.post({ type: "tile", asked: message.asked, tile: await this.tile(message.asked) });
                break;
            case "goToStep":
                await this.sessions.request("goToStep", { step: message.step });
                break;
            case "goTo": {
                const { axis, position } = message;
                const line = { from: position, to: position, width: 1, top: 0, bottom: 0 };
                const part = { axis, ...line, names: false, curves: [], coarse: false };
                const tile = await this.tile(part);
                if (tile) await this.sessions.request("goToStep", { step: tile.first });
                break;
            }
            case "export":
                await this.export(message);
                break;
        }
    }

    /** A part of the timeline; null while the run is moving or when it has ended. */
    private async tile(asked: TileRequest): Promise<Tile | null> {
        try {
            return ((await this.sessions.current?.customRequest("timeline", asked)) as Tile | undefined) ?? null;
        } catch {
            return null;
        }
    }

    private async export(message: Extract<FromTimeline, { type: "export" }>): Promise<void> {
        const { format, axis, from, to, curves, theme } = message;
        const options = { format, axis, from, to, curves, theme, width: 1400 };
        const file = (await this.sessions.request("exportTimeline", options)) as { text: string } | undefined;
        const program: unknown = this.sessions.current?.configuration["program"];
        if (!file || typeof program !== "string") return;
        const extension = format === "mermaid" ? "mmd" : format;
        const name = `${path.basename(program).replace(/\.\w+$/, "")}.run.${extension}`;
        const target = await vscode.window.showSaveDialog({
            defaultUri: vscode.Uri.joinPath(vscode.Uri.file(program), "..", name),
            filters: { [format === "mermaid" ? "Mermaid" : format.toUpperCase()]: [extension] },
        });
        if (target) await vscode.workspace.fs.writeFile(target, Buffer.from(file.text, "utf8"));
    }
}

/** The view of the timeline in the panel. */
export class TimelineView implements vscode.Disposable, vscode.WebviewViewProvider {
    private readonly registration: vscode.Disposable;
    private readonly source: TimelineSource;
    private view: vscode.WebviewView | undefined;

    constructor(
        private readonly context: vscode.ExtensionContext,
        sessions: DebugSessions,
    ) {
        this.source = new TimelineSource(sessions, (message) => void this.view?.webview.postMessage(message));
        this.registration = vscode.window.registerWebviewViewProvider(VIEW, this, {
            webviewOptions: { retainContextWhenHidden: true },
        });
    }

    resolveWebviewView(view: vscode.WebviewView): void {
        this.view = view;
        const dist = vscode.Uri.joinPath(this.context.extensionUri, "dist");
        view.webview.options = { enableScripts: true, enableForms: false, localResourceRoots: [dist] };
        view.webview.html = webviewPage(view.webview, dist, "timeline.js", ["view.css", "timeline.css"]);
        view.webview.onDidReceiveMessage((message: FromTimeline) => void this.source.receive(message));
        view.onDidDispose(() => (this.view = undefined));
    }

    dispose(): void {
        this.registration.dispose();
        this.source.dispose();
    }
}

function words(): TimelineWords {
    return {
        zoomIn: vscode.l10n.t("Zoom in"),
        zoomOut: vscode.l10n.t("Zoom out"),
        fit: vscode.l10n.t("Fit"),
        selection: vscode.l10n.t("Zoom to Selection"),
        time: vscode.l10n.t("Time"),
        steps: vscode.l10n.t("Steps"),
        exports: {
            svg: vscode.l10n.t("Export the selection, or everything, as SVG"),
            mermaid: vscode.l10n.t("Export the selection, or everything, as Mermaid"),
            csv: vscode.l10n.t("Export the selection, or everything, as CSV"),
        },
        curves: vscode.l10n.t("Curves"),
        noCurves: vscode.l10n.t("No number has changed in this run."),
        help: vscode.l10n.t(
            "A click goes to a step, left and right arrow keys move by one step, Home and End to the start and the end, + and - zoom, 0 shows the whole run, dragging or keys with Shift select a part.",
        ),
        nothing: vscode.l10n.t("No run is being debugged."),
    };
}
