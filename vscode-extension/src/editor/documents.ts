// SPDX-License-Identifier: Apache-2.0
/** The kind of the active document according to the server, for commands and for `when` clauses of menus. */

import * as vscode from "vscode";
import { about, type About } from "../protocol";
import type { LanguageServer } from "./server";

const NOTHING: About = { kind: "", systems: [], hasTree: false };
const LANGUAGES = new Set(["ascxml", "scxml", "xml", "jani"]);

export class Documents implements vscode.Disposable {
    private readonly subscriptions: vscode.Disposable[];
    private asked = 0;

    constructor(private readonly server: LanguageServer) {
        const update = () => void this.update();
        this.subscriptions = [
            vscode.window.onDidChangeActiveTextEditor(update),
            vscode.workspace.onDidSaveTextDocument(update),
            vscode.languages.onDidChangeDiagnostics(update),
            server.onState(update),
        ];
    }

    async about(document: vscode.TextDocument | undefined): Promise<About> {
        if (!document || !LANGUAGES.has(document.languageId)) return NOTHING;
        return (await this.server.ask(about, { textDocument: { uri: document.uri.toString() } })) ?? NOTHING;
    }

    /** The system that contains a document; if there are several, the user chooses one. */
    async system(document: vscode.TextDocument | undefined): Promise<vscode.Uri | undefined> {
        const { systems } = await this.about(document);
        if (systems.length === 0) {
            const text = vscode.l10n.t(
                "This file is not part of a system. Open a system file, or a file that a system names.",
            );
            void vscode.window.showInformationMessage(text);
        }
        if (systems.length < 2) return systems[0] === undefined ? undefined : vscode.Uri.parse(systems[0]);
        const items = systems.map((system) => {
            const uri = vscode.Uri.parse(system);
            return { label: vscode.workspace.asRelativePath(uri), uri };
        });
        const title = vscode.l10n.t("Which system?");
        return (await vscode.window.showQuickPick(items, { title }))?.uri;
    }

    dispose(): void {
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    private async update(): Promise<void> {
        const asked = ++this.asked;
        const { kind, systems, hasTree } = await this.about(vscode.window.activeTextEditor?.document);
        if (asked !== this.asked) return;
        const contexts = { kind, inSystem: systems.length > 0, hasTree };
        for (const [name, value] of Object.entries(contexts)) {
            void vscode.commands.executeCommand("setContext", `as2fm.${name}`, value);
        }
    }
}
