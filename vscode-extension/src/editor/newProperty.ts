// SPDX-License-Identifier: Apache-2.0
/** Asks for a sentence, its events and a time, and writes the property into the property file of the system. */

import * as vscode from "vscode";
import { newPropertyEdit, propertySentences, type PropertySentence } from "../protocol";
import type { LanguageServer } from "./server";

/** Create a property of a system, save its files, and open it. */
export async function newProperty(server: LanguageServer, system: string): Promise<void> {
    const { client } = server;
    const textDocument = { uri: system };
    const known = await server.ask(propertySentences, { textDocument });
    if (!known || !client) return;
    if (known.events.length === 0) {
        void vscode.window.showInformationMessage(
            vscode.l10n.t("The system sends no event that a property could name."),
        );
        return;
    }
    const sentence = await chooseSentence(known.sentences);
    if (!sentence) return;
    const events: string[] = [];
    for (const letter of sentence.letters) {
        const title = vscode.l10n.t("{0} – what is {1}?", said(sentence, events), letter);
        const event = await vscode.window.showQuickPick(known.events, { title });
        if (event === undefined) return;
        events.push(event);
    }
    const within = known.hasClock ? await chooseTime(said(sentence, events), sentence.needsTime) : "";
    if (within === undefined) return;
    const made = await server.ask(newPropertyEdit, { textDocument, sentence: sentence.id, events, within });
    const edit = made && (await client.protocol2CodeConverter.asWorkspaceEdit(made.edit));
    if (!edit || !(await vscode.workspace.applyEdit(edit))) return;
    for (const [uri] of edit.entries()) await (await vscode.workspace.openTextDocument(uri)).save();
    const document = await vscode.workspace.openTextDocument(client.protocol2CodeConverter.asUri(made.uri));
    const at = document.positionAt(document.getText().indexOf(`id="${made.name}"`) + 'id="'.length);
    const selection = new vscode.Range(at, at.translate(0, made.name.length));
    await vscode.window.showTextDocument(document, { selection });
}

async function chooseSentence(sentences: readonly PropertySentence[]): Promise<PropertySentence | undefined> {
    const items = sentences.map((sentence) => ({ label: sentence.text, description: sentence.id, sentence }));
    const title = vscode.l10n.t("What must the system do?");
    const picked = await vscode.window.showQuickPick(items, { title, matchOnDescription: true });
    return picked?.sentence;
}

/** The sentence with the events that are known already. */
function said(sentence: PropertySentence, events: readonly string[]): string {
    return events.reduce(
        (text, event, i) => text.replace(new RegExp(`\\b${sentence.letters[i] ?? ""}\\b( happens)?`), event),
        sentence.text,
    );
}

async function chooseTime(sentence: string, isNeeded: boolean): Promise<string | undefined> {
    const optional = isNeeded ? "" : vscode.l10n.t("leave empty for any time");
    return vscode.window.showInputBox({
        title: vscode.l10n.t("{0} – within how many seconds?", sentence),
        placeHolder: optional,
        validateInput: (value) =>
            (value === "" && !isNeeded) || (/^\d*\.?\d+$/.test(value) && Number(value) > 0)
                ? undefined
                : vscode.l10n.t("A number of seconds, such as 5"),
    });
}
