// SPDX-License-Identifier: Apache-2.0
/** The context menus of pictures: go to a part, or change the text at it. The server computes the edits. */

import * as vscode from "vscode";
import { PICTURE_ACTIONS, type MenuContext, type MenuPart, type PictureAction } from "../pictures/contract";
import { pictureEdit, type PictureEdit, type PictureEditParams, type PictureQuestion } from "../protocol";
import { toggle } from "./breakpoints";
import type { PicturePanels } from "./picturePanels";
import { jump, type PictureSource } from "./pictureSource";
import { columnFor } from "./recentEditor";
import type { LanguageServer } from "./server";

/** A picture takes the focus back when its menu closes. This must not close a question that is already open. */
const LASTING = { ignoreFocusOut: true };

export class PictureActions implements vscode.Disposable {
    private readonly commands: readonly vscode.Disposable[];
    /** The file that was changed last from a picture. */
    private changed: vscode.Uri | undefined;

    constructor(
        private readonly server: LanguageServer,
        private readonly pictures: PicturePanels,
    ) {
        pictures.onChangeBack = (source, which) => this.changeBack(source, which);
        this.commands = [
            vscode.commands.registerCommand("as2fm.picture.goTo", async ({ as2fmParts }: MenuContext) => {
                const part = await chooseOne(as2fmParts);
                if (part) await jump(part.place, false);
            }),
            vscode.commands.registerCommand("as2fm.picture.breakpoint", async ({ as2fmBreakpoints }: MenuContext) => {
                const breakpoint = await chooseOne(as2fmBreakpoints);
                if (breakpoint) toggle(breakpoint);
            }),
            ...PICTURE_ACTIONS.map((action) =>
                vscode.commands.registerCommand(`as2fm.picture.${action}`, ({ as2fmParts }: MenuContext) =>
                    this.act(action, as2fmParts),
                ),
            ),
        ];
    }

    dispose(): void {
        for (const command of this.commands) command.dispose();
    }

    private async act(action: PictureAction, parts: readonly MenuPart[]): Promise<void> {
        const possible = parts.filter(({ actions }) => actions.includes(action));
        const part = await chooseOne(possible);
        if (!part && possible.length > 0) return;
        const uri = part?.place.uri ?? this.pictures.uriOf("machine")?.toString();
        if (uri === undefined) return;
        const answer = await this.ask({ textDocument: { uri }, range: part?.place.range ?? null, action, answers: [] });
        const edit = await this.server.client?.protocol2CodeConverter.asWorkspaceEdit(answer?.edit ?? null);
        if (!edit) return;
        // The edit is shown, and can be undone, in the text.
        if (part) await jump(part.place, false, true);
        else await vscode.window.showTextDocument(vscode.Uri.parse(uri), { preserveFocus: true });
        if (await vscode.workspace.applyEdit(edit)) this.changed = vscode.Uri.parse(uri);
    }

    /** Undo or redo in the text, where VS Code keeps the changes, and return to the picture. */
    private async changeBack(source: PictureSource, which: "undo" | "redo"): Promise<void> {
        const uri = this.changed;
        if (!uri) return;
        await vscode.window.showTextDocument(uri, { viewColumn: columnFor(uri) });
        await vscode.commands.executeCommand(which);
        source.host.focus();
    }

    /** Ask the server for an edit, and the user for what the server still needs. */
    private async ask(params: PictureEditParams): Promise<PictureEdit | undefined> {
        const answer = await this.server.ask(pictureEdit, params);
        if (!answer?.question) {
            if (answer && answer.problem !== "") void vscode.window.showErrorMessage(answer.problem);
            return answer;
        }
        const extended = (text: string) => ({ ...params, answers: [...params.answers, text] });
        const problem = async (text: string) => (await this.server.ask(pictureEdit, extended(text)))?.problem;
        const text = await put(answer.question, problem);
        return text === undefined ? undefined : this.ask(extended(text));
    }
}

async function chooseOne<Part extends { readonly label: string }>(parts: readonly Part[]): Promise<Part | undefined> {
    if (parts.length < 2) return parts[0];
    const items = parts.map((part) => ({ label: part.label, part }));
    return (await vscode.window.showQuickPick(items, { title: vscode.l10n.t("Which part?"), ...LASTING }))?.part;
}

/** Ask the user a question. `problem` returns why a text is not a valid answer, or an empty text. */
async function put(
    { text, options, proposal }: PictureQuestion,
    problem: (text: string) => Promise<string | undefined>,
): Promise<string | undefined> {
    if (options.length > 0) {
        const items = options.map(({ label, description, answer }) => ({ label, description, answer }));
        return (await vscode.window.showQuickPick(items, { title: text, matchOnDescription: true, ...LASTING }))
            ?.answer;
    }
    const validateInput = async (written: string) => (written === proposal ? undefined : await problem(written));
    return vscode.window.showInputBox({ title: text, value: proposal, validateInput, ...LASTING });
}
