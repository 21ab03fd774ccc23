// SPDX-License-Identifier: Apache-2.0
/** While a run is stopped, the open pictures show its activity. A command shows all of them side by side. */

import * as vscode from "vscode";
import type { Activity } from "../pictures/contract";
import type { DebugSessions } from "./debugSessions";
import type { ActiveNode, PicturePanels } from "./picturePanels";

/** The answer to the request `pictures` (docs/debugging.md). */
interface Answer {
    readonly nodes: readonly (Omit<ActiveNode, "path"> & { readonly source: { readonly path: string } })[];
    readonly edges: Activity["edges"];
}

/** The source on the left; on the right all machines above the tree and the ROS graph. */
const LAYOUT = {
    orientation: 0,
    groups: [{ size: 0.35 }, { size: 0.65, groups: [{ size: 0.55 }, { size: 0.45, groups: [{}, {}] }] }],
};

export class PictureActivity implements vscode.Disposable {
    private readonly subscriptions: vscode.Disposable[];

    constructor(
        private readonly sessions: DebugSessions,
        private readonly pictures: PicturePanels,
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
        await vscode.commands.executeCommand("vscode.setEditorLayout", LAYOUT);
        await this.pictures.open("system", uri, vscode.ViewColumn.Two);
        await this.pictures.open("tree", uri, vscode.ViewColumn.Three);
        await this.pictures.open("ros", uri, vscode.ViewColumn.Four);
    }
}
