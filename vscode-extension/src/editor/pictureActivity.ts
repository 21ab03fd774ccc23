// SPDX-License-Identifier: Apache-2.0
/** While a run is stopped, the open pictures show its activity. A command shows all of them side by side. */

import * as vscode from "vscode";
import type { Activity, PictureKind } from "../pictures/contract";
import { about } from "../protocol";
import type { DebugSessions } from "./debugSessions";
import type { ActiveNode, PicturePanels } from "./picturePanels";
import type { LanguageServer } from "./server";

/** The answer to the request `pictures` (docs/debugging.md). */
interface Answer {
    readonly nodes: readonly (Omit<ActiveNode, "path"> & { readonly source: { readonly path: string } })[];
    readonly edges: Activity["edges"];
}

/** The columns of the pictures, beside that of the source. */
const COLUMNS = [vscode.ViewColumn.Two, vscode.ViewColumn.Three, vscode.ViewColumn.Four];

/** The source on the left; on the right one picture, two above each other, or the first above the two others. */
function layoutOf(pictures: number): object {
    const lower = { size: 0.45, ...(pictures > 2 && { groups: [{}, {}] }) };
    const right = { size: 0.65, ...(pictures > 1 && { groups: [{ size: 0.55 }, lower] }) };
    return { orientation: 0, groups: [{ size: 0.35 }, right] };
}

export class PictureActivity implements vscode.Disposable {
    private readonly subscriptions: vscode.Disposable[];

    constructor(
        private readonly sessions: DebugSessions,
        private readonly pictures: PicturePanels,
        private readonly server: LanguageServer,
    ) {
        this.subscriptions = [
            sessions.onStopped((session) => void this.update(session)),
            sessions.onEnded(() => {
                pictures.showActivity([], []);
            }),
            vscode.commands.registerCommand("as2fm.showRun", () => this.showAll()),
        ];
    }

    dispose(): void {
        for (const part of this.subscriptions) part.dispose();
    }

    private async update(session: vscode.DebugSession): Promise<void> {
        try {
            const { nodes, edges } = (await session.customRequest("pictures")) as Answer;
            this.pictures.showActivity(
                nodes.map(({ source, ...node }) => ({ ...node, path: source.path })),
                edges,
            );
        } catch {
            // The run is moving again; its activity is shown where it stops.
        }
    }

    private async showAll(): Promise<void> {
        const program: unknown = (this.sessions.current ?? vscode.debug.activeDebugSession)?.configuration["program"];
        if (typeof program !== "string") return;
        const uri = vscode.Uri.file(program);
        const kinds = await this.kindsOf(uri);
        if (kinds.length === 0) {
            const text = vscode.l10n.t("There are no diagrams of {0}.", vscode.workspace.asRelativePath(uri));
            void vscode.window.showInformationMessage(text);
            return;
        }
        await vscode.commands.executeCommand("vscode.setEditorLayout", layoutOf(kinds.length));
        for (const [index, kind] of kinds.entries()) await this.pictures.open(kind, uri, COLUMNS[index]);
    }

    /** The kinds of pictures of a model that is debugged: a tree without a system has only its own, a JANI model none. */
    private async kindsOf(uri: vscode.Uri): Promise<readonly PictureKind[]> {
        const { kind, hasTree } = (await this.server.ask(about, { textDocument: { uri: uri.toString() } })) ?? {};
        if (kind === "tree") return ["tree"];
        if (kind === "system") return hasTree ? ["system", "tree", "ros"] : ["system", "ros"];
        return [];
    }
}
