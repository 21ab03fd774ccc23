// SPDX-License-Identifier: Apache-2.0
/** Lets the user choose the expectation of a property, and writes it beside the property or into the configuration. */

import * as vscode from "vscode";
import { expectations, setExpectation } from "../protocol";
import type { LanguageServer } from "./server";

const COMPARISON = /^\s*(>=|<=|==|≥|≤|>|<|=)\s*-?\d*\.?\d+(e-?\d+)?\s*$/;

/** Let the user choose an expectation; return whether one was set. */
export async function chooseExpectation(server: LanguageServer, system: string, property: string): Promise<boolean> {
    const of = { textDocument: { uri: system }, property };
    const known = await server.ask(expectations, of);
    if (!known) return false;
    const title = vscode.l10n.t("The expected value of {0}, which is written into {1}", property, known.file);
    const expected = await choose(title, known.suggestions, known.current);
    if (expected === undefined) return false;
    const answer = await server.ask(setExpectation, { ...of, expected });
    const { client } = server;
    if (!answer || !client) return false;
    const edit = await client.protocol2CodeConverter.asWorkspaceEdit(answer.edit ?? undefined);
    if (!edit) {
        void vscode.window.showErrorMessage(answer.problem);
        return false;
    }
    const uri = client.protocol2CodeConverter.asUri(answer.uri);
    const isEdited = vscode.workspace.textDocuments.some(
        (document) => document.uri.toString() === uri.toString() && document.isDirty,
    );
    if (!(await vscode.workspace.applyEdit(edit))) return false;
    // The server reads the configuration from the disk, so it is saved. Other changes of the user are not saved.
    if (!isEdited) await (await vscode.workspace.openTextDocument(uri)).save();
    return true;
}

async function choose(
    title: string,
    suggestions: readonly string[],
    current: readonly string[],
): Promise<string | undefined> {
    const other = {
        label: vscode.l10n.t("Another value…"),
        detail: vscode.l10n.t(
            "Values are offered that the known result meets. With others, the expectation would fail or stay undecided.",
        ),
    };
    const met = vscode.l10n.t("met by the result");
    const items = [...suggestions.map((label) => ({ label, description: met })), other];
    const placeHolder = current.length > 0 ? vscode.l10n.t("currently {0}", current.join(", ")) : undefined;
    const options = placeHolder === undefined ? { title } : { title, placeHolder };
    const picked = suggestions.length > 0 ? await vscode.window.showQuickPick(items, options) : other;
    if (picked !== other) return picked?.label;
    return vscode.window.showInputBox({
        title,
        ...(suggestions.length === 0 && {
            prompt: vscode.l10n.t(
                "No value is offered, because the property has not been verified, or its result meets no comparison.",
            ),
        }),
        value: current[0] ?? ">= 0.95",
        validateInput: (value) =>
            COMPARISON.test(value) ? undefined : vscode.l10n.t("A comparison with a number, such as >= 0.95"),
    });
}
