// SPDX-License-Identifier: Apache-2.0
/** While a run is stopped, the open pictures show its activity. */

import * as vscode from "vscode";
import type { Activity } from "../pictures/contract";
import type { DebugSessions } from "./debugSessions";
import type { PicturePanels } from "./picturePanels";
import type { ActiveNode } from "./pictureSource";

/** The answer to the request `pictures` (docs/debugging.md). */
export interface Answer {
    readonly nodes: readonly (Omit<ActiveNode, "path"> & { readonly source: { readonly path: string } })[];
    readonly edges: Activity["edges"];
}

export function activeNodes({ nodes }: Answer): ActiveNode[] {
    return nodes.map(({ source, ...node }) => ({ ...node, path: source.path }));
}

export class PictureActivity implements vscode.Disposable {
    private readonly subscriptions: vscode.Disposable[];

    constructor(
        sessions: DebugSessions,
        private readonly pictures: PicturePanels,
    ) {
        this.subscriptions = [
            sessions.onStopped((session) => void this.update(session)),
            sessions.onEnded(() => {
                pictures.showActivity([], []);
            }),
        ];
    }

    dispose(): void {
        for (const part of this.subscriptions) part.dispose();
    }

    private async update(session: vscode.DebugSession): Promise<void> {
        try {
            const answer = (await session.customRequest("pictures")) as Answer;
            this.pictures.showActivity(activeNodes(answer), answer.edges);
        } catch {
            // The run is moving again; its activity is shown where it stops.
        }
    }
}
