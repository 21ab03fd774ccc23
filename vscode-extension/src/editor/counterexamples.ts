// SPDX-License-Identifier: Apache-2.0
/** The view that shows step by step why a property fails. A step opens its source and is highlighted in pictures. */

import * as vscode from "vscode";
import { counterexample, type Counterexample, type Step } from "../protocol";
import { jump, type PicturePanels } from "./picturePanels";
import type { LanguageServer } from "./server";

const VIEW = "as2fm.counterexample";
const SHOW_STEP = "as2fm.showStep";

/** An effect of a step. It is an object, because VS Code compares entries by identity and effects may be equal. */
interface Detail {
    readonly of: Step;
    readonly text: string;
}

type Entry = Step | Detail;

export class Counterexamples implements vscode.Disposable, vscode.TreeDataProvider<Entry> {
    private readonly changed = new vscode.EventEmitter<undefined>();
    private readonly view: vscode.TreeView<Entry>;
    private readonly subscriptions: { dispose(): unknown }[];
    private shown: Counterexample | undefined;

    readonly onDidChangeTreeData = this.changed.event;

    constructor(
        private readonly server: LanguageServer,
        private readonly pictures: PicturePanels,
    ) {
        this.view = vscode.window.createTreeView<Entry>(VIEW, { treeDataProvider: this, showCollapseAll: true });
        this.subscriptions = [
            this.changed,
            this.view,
            vscode.commands.registerCommand(SHOW_STEP, (step: Step) => this.showStep(step)),
        ];
    }

    /** Show the trace that contradicts a property or, as a witness, one that supports it. */
    async show(system: string, property: string, witness = false): Promise<void> {
        const trace = await this.server.ask(counterexample, { textDocument: { uri: system }, property, witness });
        if (!trace) {
            const text = witness
                ? vscode.l10n.t("There is no trace that speaks for {0}, or it has not been verified.", property)
                : vscode.l10n.t("There is no trace that contradicts {0}, or it has not been verified.", property);
            void vscode.window.showInformationMessage(text);
            return;
        }
        this.shown = trace;
        this.view.description = trace.property;
        this.view.message = trace.stale
            ? vscode.l10n.t("{0} The files have changed since then.", `${trace.heading}.`)
            : `${trace.heading}.`;
        await vscode.commands.executeCommand("setContext", "as2fm.hasCounterexample", true);
        this.changed.fire(undefined);
        await vscode.commands.executeCommand(`${VIEW}.focus`);
        const first = trace.steps[0];
        if (first) await this.view.reveal(first, { focus: true, select: true });
    }

    getTreeItem(entry: Entry): vscode.TreeItem {
        if ("of" in entry) {
            const item = new vscode.TreeItem(entry.text);
            item.iconPath = new vscode.ThemeIcon("symbol-variable");
            return item;
        }
        const { Expanded, None } = vscode.TreeItemCollapsibleState;
        const label = entry.who === "" ? entry.what : `${entry.who}: ${entry.what}`;
        const item = new vscode.TreeItem(label, entry.details.length > 0 ? Expanded : None);
        item.description = [entry.time, entry.place].filter((text) => text !== "").join(" · ");
        item.tooltip = [label, item.description, ...entry.details].join("\n");
        if (entry.uri !== undefined) {
            item.iconPath = new vscode.ThemeIcon("debug-stackframe-dot");
            item.command = { command: SHOW_STEP, title: vscode.l10n.t("Show Step"), arguments: [entry] };
        }
        return item;
    }

    getChildren(entry?: Entry): Entry[] {
        if (entry === undefined) return [...(this.shown?.steps ?? [])];
        return "of" in entry ? [] : entry.details.map((text) => ({ of: entry, text }));
    }

    getParent(entry: Entry): Entry | undefined {
        return "of" in entry ? entry.of : undefined;
    }

    dispose(): void {
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    private async showStep({ uri, range, highlights }: Step): Promise<void> {
        if (uri === undefined || !range) return;
        await jump({ uri, range }, false, true);
        await this.pictures.highlight(highlights);
    }
}
