// SPDX-License-Identifier: Apache-2.0
/**
 * The view that shows step by step why a property fails. A step opens its source, is highlighted in pictures, and its
 * state is shown beside it.
 */

import * as vscode from "vscode";
import { counterexample, traceState, type Counterexample, type Step } from "../protocol";
import { ON_STAGE, type Debugging } from "./debugging";
import type { PicturePanels } from "./picturePanels";
import { jump } from "./pictureSource";
import type { LanguageServer } from "./server";
import { TraceStateView } from "./traceState";

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
    private readonly state = new TraceStateView();
    private shown: Counterexample | undefined;
    private system = "";
    private current: Step | undefined;

    readonly onDidChangeTreeData = this.changed.event;

    constructor(
        private readonly server: LanguageServer,
        private readonly pictures: PicturePanels,
        private readonly debugging: Debugging,
    ) {
        this.view = vscode.window.createTreeView<Entry>(VIEW, { treeDataProvider: this, showCollapseAll: true });
        this.subscriptions = [
            this.changed,
            this.view,
            this.state,
            vscode.commands.registerCommand(SHOW_STEP, (step: Step) => this.showStep(step)),
            vscode.commands.registerCommand("as2fm.nextStep", () => this.move(1)),
            vscode.commands.registerCommand("as2fm.previousStep", () => this.move(-1)),
            vscode.commands.registerCommand("as2fm.showTraceOnStage", () => this.showOnStage()),
        ];
    }

    /** Show the trace that contradicts a property or, as a witness, one that supports it. */
    async show(system: string, property: string, witness = false): Promise<void> {
        const trace = await this.server.ask(counterexample, { textDocument: { uri: system }, property, witness });
        if (!trace) {
            const text = witness
                ? vscode.l10n.t("There is no trace that supports {0}, or {0} has not been verified.", property)
                : vscode.l10n.t("There is no trace that contradicts {0}, or {0} has not been verified.", property);
            void vscode.window.showInformationMessage(text);
            return;
        }
        this.shown = trace;
        this.system = system;
        this.view.description = trace.property;
        this.view.message = trace.stale
            ? vscode.l10n.t("{0} The files have changed since then.", `${trace.heading}.`)
            : `${trace.heading}.`;
        await vscode.commands.executeCommand("setContext", "as2fm.hasCounterexample", true);
        this.changed.fire(undefined);
        await vscode.commands.executeCommand(`${VIEW}.focus`);
        const last = trace.steps.at(-1);
        if (!last) return;
        await this.view.reveal(last, { focus: true, select: true });
        await this.showStep(last);
    }

    /** Debug the trace on the stage, from its start. */
    private async showOnStage(): Promise<void> {
        const system = this.server.client?.protocol2CodeConverter.asUri(this.system);
        if (!this.shown || !system) return;
        const { property, seed, trace } = this.shown;
        await this.debugging.start(system, { property, seed, trace, stopOnEntry: true, [ON_STAGE]: true });
    }

    /** Select the step `by` steps after the selected step; before it if `by` is negative. */
    private async move(by: number): Promise<void> {
        const steps = this.shown?.steps ?? [];
        const selected = this.view.selection[0];
        const from = selected === undefined ? this.current : "of" in selected ? selected.of : selected;
        const to = from && steps[steps.indexOf(from) + by];
        if (!to) return;
        await this.view.reveal(to, { focus: true, select: true });
        await this.showStep(to);
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

    private async showStep(step: Step): Promise<void> {
        this.current = step;
        const { uri, range, highlights } = step;
        if (uri !== undefined && range) await jump({ uri, range }, false, true);
        await this.pictures.highlight(highlights);
        await this.showState(step);
    }

    /** The state after the turn of a step, compared with the one before the turn. */
    private async showState(step: Step): Promise<void> {
        const { shown } = this;
        if (!shown) return;
        const rows = await this.server.ask(traceState, {
            textDocument: { uri: this.system },
            property: shown.property,
            trace: shown.trace,
            step: step.lastStep,
            earlier: Math.max(0, step.step - 1),
        });
        if (this.current !== step) return;
        const after = vscode.l10n.t("after step {0}", step.lastStep);
        this.state.show(rows ?? [], step.time === "" ? after : `${after}, ${step.time}`);
    }
}
