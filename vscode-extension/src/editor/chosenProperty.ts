// SPDX-License-Identifier: Apache-2.0
/** The property that a command of the palette is about, which has no arguments. */

import * as vscode from "vscode";
import type { Property, VerifiableSystem } from "../protocol";
import type { Asked } from "./tests";

/** Let the user choose one of the properties to which a command applies. If there is none, `none` says what to do. */
export async function chosenProperty(
    systems: readonly VerifiableSystem[],
    applies: (property: Property) => boolean,
    none: string,
): Promise<Asked | undefined> {
    const all = systems.flatMap(({ uri, properties }) =>
        properties.filter(applies).map((property) => ({ uri, property })),
    );
    // Those that fail are probably meant.
    const sorted = all.sort((one, other) => Number(isFailed(other.property)) - Number(isFailed(one.property)));
    const items = sorted.map(({ uri, property: { name, comment, view } }) => ({
        label: name,
        description: [view?.words ?? "", systems.length > 1 ? nameOf(uri) : ""].filter((text) => text).join(" · "),
        detail: comment,
        asked: { system: uri, property: name },
    }));
    if (items.length === 0) void vscode.window.showInformationMessage(none);
    if (items.length < 2) return items[0]?.asked;
    const options = { title: vscode.l10n.t("Which property?"), matchOnDescription: true, matchOnDetail: true };
    return (await vscode.window.showQuickPick(items, options))?.asked;
}

function isFailed({ view }: Property): boolean {
    return view?.mark === "failed";
}

function nameOf(system: string): string {
    return vscode.workspace.asRelativePath(vscode.Uri.parse(system));
}
