// SPDX-License-Identifier: Apache-2.0
/** The command that shows a counterexample or a witness beside the nearest run with the opposite verdict. */

import * as vscode from "vscode";
import { counterexample, parting, type Counterexample, type Parting } from "../protocol";
import { PICTURES, type PicturePane } from "../stage/contract";
import { differing } from "./counterexamples";
import { AT_STEP, COMPARED_WITH, ON_STAGE, type Debugging } from "./debugging";
import type { LanguageServer } from "./server";
import type { ComparedWith } from "./stage";
import type { Asked } from "./tests";

/** With `witness`, the trace that supports the property is compared with one that contradicts it. */
export async function compareRuns(
    server: LanguageServer,
    debugging: Debugging,
    { system, property, witness = false }: Asked & { readonly witness?: boolean },
): Promise<void> {
    const params = { textDocument: { uri: system }, property, witness };
    const [shown, parts] = [await server.ask(counterexample, params), await server.ask(parting, params)];
    const uri = server.client?.protocol2CodeConverter.asUri(system);
    const other = parts?.trace ?? null;
    if (!shown || !parts || other === null || !uri) {
        const text = vscode.l10n.t(
            "There is no random trace with the opposite verdict with which the trace of {0} can be compared. Verify the property with more traces.",
            property,
        );
        void vscode.window.showInformationMessage(text);
        return;
    }
    const { seed, trace } = shown;
    const compared: ComparedWith = {
        trace: other,
        comparison: comparisonOf(shown, parts, other),
        picture: pictureOf(parts),
    };
    const step = parts.alignment.here.step;
    const onStage = { [ON_STAGE]: true, [AT_STEP]: step, [COMPARED_WITH]: compared };
    await debugging.start(uri, { property, seed, trace, stopOnEntry: true, ...onStage });
}

function comparisonOf({ trace, verdict }: Counterexample, parts: Parting, other: number): ComparedWith["comparison"] {
    const isFailed = verdict === "failed";
    const { here, alignment } = parts;
    const time = here.time === "" ? "" : `, ${here.time}`;
    const where = vscode.l10n.t("step {0}", alignment.here.step + 1) + time;
    return {
        alignment,
        runs: {
            here: { title: titleOf(trace, isFailed), choice: differing(parts, "here") },
            there: { title: titleOf(other, !isFailed), choice: differing(parts, "there") },
        },
        before: vscode.l10n.t("Up to here, both runs do the same. They part at {0}: {1}", where, here.who),
        at: vscode.l10n.t("Here the runs part, at {0}: {1}", where, here.who),
        after: vscode.l10n.t("The runs have parted at {0}: {1}", where, here.who),
        step: vscode.l10n.t("Step"),
        goToParting: vscode.l10n.t("Where the Runs Part"),
    };
}

function titleOf(trace: number, isFailed: boolean): string {
    return isFailed ? vscode.l10n.t("Trace {0}: does not hold", trace) : vscode.l10n.t("Trace {0}: holds", trace);
}

/** The picture with the turn that differs. A machine is one of those of the system. */
function pictureOf({ here }: Parting): PicturePane {
    const kinds = here.highlights.map(({ kind }) => (kind === "machine" ? "system" : kind));
    return PICTURES.find((kind) => kinds.includes(kind)) ?? "system";
}
