// SPDX-License-Identifier: Apache-2.0
/**
 * The view that shows step by step why a property fails, and where the nearest trace with the opposite verdict parts from
 * this one. A step opens its source, is highlighted in pictures, and its state is shown beside it.
 */

import * as vscode from "vscode";
import { counterexample, parting, traceState, type Counterexample, type Parting, type Step } from "../protocol";
import { folded } from "../verification/folded";
import { AT_STEP, ON_STAGE, type Debugging } from "./debugging";
import type { PicturePanels } from "./picturePanels";
import { jump } from "./pictureSource";
import type { LanguageServer } from "./server";
import type { Asked } from "./tests";
import { TraceStateView } from "./traceState";

const VIEW = "as2fm.counterexample";
const SHOW_STEP = "as2fm.showStep";

/** A step of the shown trace, or one of the two sides of a parting. */
interface Turn {
    /** Null if the automaton takes no further turn on this side. */
    readonly step: Step | null;
    /** The number of the trace; null if it has none. */
    readonly trace: number | null;
    readonly side: "" | "here" | "there";
}

/** An effect of a step. It is an object, because VS Code compares entries by identity and effects may be equal. */
interface Detail {
    readonly of: Turn;
    readonly text: string;
}

/** The text above the list if it is long, and a line of it. */
interface Reason {
    readonly reasons: readonly ReasonLine[];
}

interface ReasonLine {
    readonly line: string;
}

interface PartingEntry {
    readonly parting: Parting;
    readonly sides: readonly Turn[];
}

type Entry = Turn | Detail | PartingEntry | Reason | ReasonLine;

export class Counterexamples implements vscode.Disposable, vscode.TreeDataProvider<Entry> {
    private readonly changed = new vscode.EventEmitter<undefined>();
    private readonly view: vscode.TreeView<Entry>;
    private readonly subscriptions: { dispose(): unknown }[];
    private readonly state = new TraceStateView();
    private shown: Counterexample | undefined;
    private turns: readonly Turn[] = [];
    private reason: Reason | undefined;
    private parting: PartingEntry | undefined;
    private isPartingShown = false;
    private isWitness = false;
    private system = "";
    /** The last step of the trace that was selected. */
    private current: Turn | undefined;
    /** The turn that was selected last, a side of the parting as well. */
    private latest: Turn | undefined;

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
            vscode.commands.registerCommand(SHOW_STEP, (turn: Turn) => this.showTurn(turn)),
            vscode.commands.registerCommand("as2fm.nextStep", () => this.move(1)),
            vscode.commands.registerCommand("as2fm.previousStep", () => this.move(-1)),
            vscode.commands.registerCommand("as2fm.showTraceOnStage", () => this.showOnStage(this.shown?.trace)),
            vscode.commands.registerCommand("as2fm.showTurnOnStage", ({ trace, step }: Turn) =>
                this.showOnStage(trace ?? undefined, step?.lastStep),
            ),
            vscode.commands.registerCommand("as2fm.showParting", () => this.showParting()),
        ];
    }

    /** Show the trace that contradicts a property or, as a witness, one that supports it. */
    async show(system: string, property: string, witness = false): Promise<void> {
        const asked = { textDocument: { uri: system }, property, witness };
        const trace = await this.server.ask(counterexample, asked);
        if (!trace) {
            const text = witness
                ? vscode.l10n.t("There is no trace that supports {0}, or {0} has not been verified.", property)
                : vscode.l10n.t("There is no trace that contradicts {0}, or {0} has not been verified.", property);
            void vscode.window.showInformationMessage(text);
            return;
        }
        this.shown = trace;
        this.turns = trace.steps.map((step) => ({ step, trace: trace.trace, side: "" }));
        this.system = system;
        this.isWitness = witness;
        const { message, lines } = folded(`${trace.heading}.`, `${trace.summary}.`);
        this.reason = lines.length > 0 ? { reasons: lines.map((line) => ({ line })) } : undefined;
        await vscode.commands.executeCommand("setContext", "as2fm.hasCounterexample", true);
        await this.setParting(undefined);
        this.isPartingShown = false;
        this.changed.fire(undefined);
        await vscode.commands.executeCommand(`${VIEW}.focus`);
        // Only a view that is visible makes space for its message.
        this.view.description = trace.property;
        this.view.message = trace.stale ? vscode.l10n.t("{0} The files have changed since then.", message) : message;
        const last = this.turns.at(-1);
        if (last) await this.select(last);
        const found = await this.server.ask(parting, asked);
        if (this.shown !== trace) return;
        if (found) await this.setParting(found);
        // The view of the state has appeared beside the list meanwhile. The message then takes more lines, which would
        // push the selected turn out of sight.
        if (last && this.latest === last) await this.view.reveal(last, { select: true });
    }

    private async setParting(parting: Parting | undefined): Promise<void> {
        const here = this.shown?.trace ?? null;
        this.parting = parting && {
            parting,
            sides: [
                { step: parting.here, trace: here, side: "here" },
                { step: parting.there, trace: parting.trace, side: "there" },
            ],
        };
        await vscode.commands.executeCommand("setContext", "as2fm.hasParting", parting !== undefined);
    }

    /**
     * Select what the shown trace does where the traces part; what the other one does is below it. Until then, the list
     * has no row for it, which would move the row that is selected at its end.
     */
    private async showParting(): Promise<void> {
        const here = this.parting?.sides[0];
        if (!here || !this.shown) return;
        this.isPartingShown = true;
        // The rows state the same as the message, below which only two of them would be visible.
        this.view.message = this.shown.stale ? vscode.l10n.t("The files have changed since then.") : "";
        this.changed.fire(undefined);
        await this.select(here);
    }

    /** The property whose trace is shown, and whether it supports the property. */
    get asked(): (Asked & { readonly witness: boolean }) | undefined {
        return this.shown && { system: this.system, property: this.shown.property, witness: this.isWitness };
    }

    /** Debug a trace on the stage, from its start or after a step. */
    private async showOnStage(trace?: number, step?: number): Promise<void> {
        const system = this.server.client?.protocol2CodeConverter.asUri(this.system);
        if (!this.shown || !system || trace === undefined) return;
        const { property, seed } = this.shown;
        const attributes = { property, seed, trace, stopOnEntry: true, [ON_STAGE]: true, [AT_STEP]: step };
        await this.debugging.start(system, attributes);
    }

    /** Select the step `by` steps after the selected step; before it if `by` is negative. */
    private async move(by: number): Promise<void> {
        const selected = this.view.selection[0];
        const turn = selected && ("of" in selected ? selected.of : selected);
        const from = turn && "step" in turn && turn.side === "" ? turn : this.current;
        const to = from && this.turns[this.turns.indexOf(from) + by];
        if (to) await this.select(to);
    }

    private async select(turn: Turn): Promise<void> {
        this.latest = turn;
        await this.view.reveal(turn, { focus: true, select: true });
        // Meanwhile, the user may have selected another one.
        if (this.latest === turn) await this.showTurn(turn);
    }

    getTreeItem(entry: Entry): vscode.TreeItem {
        if ("of" in entry) {
            const item = new vscode.TreeItem(entry.text);
            item.iconPath = new vscode.ThemeIcon("symbol-variable");
            return item;
        }
        if ("reasons" in entry) return reasonItem(entry);
        if ("line" in entry) return new vscode.TreeItem(entry.line);
        return "parting" in entry ? partingItem(entry.parting) : this.turnItem(entry);
    }

    private turnItem(turn: Turn): vscode.TreeItem {
        const { Expanded, None } = vscode.TreeItemCollapsibleState;
        const { step, side } = turn;
        const parting = side === "" ? undefined : this.parting?.parting;
        if (!step) return new vscode.TreeItem(parting ? sideLabel(parting, "there") : "");
        const label = step.who === "" ? step.what : `${step.who}: ${step.what}`;
        const item = new vscode.TreeItem(label, side === "" && step.details.length > 0 ? Expanded : None);
        if (side !== "" && parting) item.label = sideLabel(parting, side);
        item.description = [step.time, step.place].filter((text) => text !== "").join(" · ");
        item.tooltip = [label, item.description, ...step.details].join("\n");
        if (side !== "" && turn.trace !== null) item.contextValue = "side";
        if (step.uri !== undefined) {
            item.iconPath = new vscode.ThemeIcon("debug-stackframe-dot");
            item.command = { command: SHOW_STEP, title: vscode.l10n.t("Show Step"), arguments: [turn] };
        }
        return item;
    }

    getChildren(entry?: Entry): Entry[] {
        if (entry === undefined) {
            const parting = this.parting && this.isPartingShown ? [this.parting] : [];
            return [...(this.reason ? [this.reason] : []), ...parting, ...this.turns];
        }
        if ("reasons" in entry) return [...entry.reasons];
        if ("line" in entry) return [];
        if ("parting" in entry) return [...entry.sides];
        return "of" in entry || entry.side !== ""
            ? []
            : (entry.step?.details ?? []).map((text) => ({ of: entry, text }));
    }

    getParent(entry: Entry): Entry | undefined {
        if ("of" in entry) return entry.of;
        if ("line" in entry) return this.reason;
        return "step" in entry && entry.side !== "" ? this.parting : undefined;
    }

    dispose(): void {
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    private async showTurn(turn: Turn): Promise<void> {
        if (!turn.step) return;
        this.latest = turn;
        if (turn.side === "") this.current = turn;
        const { uri, range, highlights } = turn.step;
        if (uri !== undefined && range) await jump({ uri, range }, false, true);
        await this.pictures.highlight(highlights);
        await this.showState(turn, turn.step);
    }

    /** The state after the turn of a step, compared with the one before the turn. */
    private async showState(turn: Turn, step: Step): Promise<void> {
        const { shown } = this;
        if (!shown) return;
        if (turn.trace === null) {
            this.state.show([], vscode.l10n.t("only known for random traces"));
            return;
        }
        const rows = await this.server.ask(traceState, {
            textDocument: { uri: this.system },
            property: shown.property,
            trace: turn.trace,
            step: step.lastStep,
            earlier: Math.max(0, step.step - 1),
        });
        if (this.latest !== turn) return;
        const after = vscode.l10n.t("after step {0}", step.lastStep);
        this.state.show(rows ?? [], step.time === "" ? after : `${after}, ${step.time}`);
    }
}

function reasonItem({ reasons }: Reason): vscode.TreeItem {
    const item = new vscode.TreeItem(vscode.l10n.t("Why"), vscode.TreeItemCollapsibleState.Collapsed);
    item.iconPath = new vscode.ThemeIcon("info");
    item.description = reasons[0]?.line ?? "";
    item.tooltip = reasons.map(({ line }) => line).join("\n");
    return item;
}

function partingItem({ heading }: Parting): vscode.TreeItem {
    const item = new vscode.TreeItem(heading, vscode.TreeItemCollapsibleState.Expanded);
    item.iconPath = new vscode.ThemeIcon("git-compare");
    item.tooltip = vscode.l10n.t("Where the traces part: {0}", heading);
    return item;
}

/** What one side does and the other does not. */
export function differing({ here, there }: Parting, side: "here" | "there"): string {
    const [one, other] = side === "here" ? [here, there] : [there, here];
    const others = other ? [other.what, ...other.details] : [];
    if (!one) return vscode.l10n.t("takes no further turn");
    const texts = [one.what, ...one.details];
    const own = texts.filter((text) => !others.includes(text));
    if (own.length > 0) return own.join(", ");
    const missing = others.filter((text) => !texts.includes(text));
    return missing.length > 0 ? vscode.l10n.t("the same without: {0}", missing.join(", ")) : one.what;
}

function sideLabel(parting: Parting, side: "here" | "there"): string {
    const text = differing(parting, side);
    return side === "here" ? vscode.l10n.t("here: {0}", text) : vscode.l10n.t("there: {0}", text);
}
