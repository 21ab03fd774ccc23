// SPDX-License-Identifier: Apache-2.0
/** The view of the possible next steps while a run is stopped. A click on a step takes it. */

import * as vscode from "vscode";
import type { DebugSessions } from "./debugSessions";

const VIEW = "as2fm.choices";
const CHOOSE = "as2fm.choose";

interface Outcome {
    readonly number: number;
    readonly text: string;
    readonly probability: number;
}

interface Choice {
    readonly number: number;
    readonly text: string;
    readonly probability: number;
    readonly isNext: boolean;
    /** Whether nobody has written the step: only automata that the translation has added do something. */
    readonly isOfTranslation: boolean;
    readonly outcomes: readonly Outcome[];
    readonly source?: { readonly path: string };
    readonly line?: number;
}

/** An event that the user can send, as in the answer to the request `events`. */
interface Sendable {
    readonly event: string;
    readonly text: string;
    readonly fields: string;
    readonly isFree: boolean;
}

/** The answer to the request `choices` (docs/debugging.md). */
interface Choices {
    readonly step: number;
    readonly time: number | null;
    readonly end: string | null;
    readonly fault: string | null;
    readonly isByHand: boolean;
    readonly isChanged: boolean;
    readonly property: string;
    readonly verdicts: Readonly<Record<string, "passed" | "failed" | "undecided">>;
    readonly choices: readonly Choice[];
}

interface ChoiceEntry {
    readonly choice: Choice;
    readonly outcome?: Outcome;
}

/** The steps of the translation, which are no decisions of a person. */
interface Hidden {
    readonly hidden: readonly ChoiceEntry[];
}

type Entry = ChoiceEntry | Hidden;

export class ChoicesView implements vscode.Disposable, vscode.TreeDataProvider<Entry> {
    private readonly changed = new vscode.EventEmitter<undefined>();
    private readonly view: vscode.TreeView<Entry>;
    private readonly subscriptions: { dispose(): unknown }[];
    private session: vscode.DebugSession | undefined;
    private entries: readonly Entry[] = [];
    private revealed: vscode.DebugSession | undefined;

    readonly onDidChangeTreeData = this.changed.event;

    constructor(
        private readonly sessions: DebugSessions,
        private readonly log: vscode.LogOutputChannel,
    ) {
        this.view = vscode.window.createTreeView<Entry>(VIEW, { treeDataProvider: this });
        this.subscriptions = [
            this.changed,
            this.view,
            vscode.commands.registerCommand(CHOOSE, (entry: ChoiceEntry) => this.choose(entry)),
            vscode.commands.registerCommand("as2fm.goToStep", () => this.goToStep()),
            vscode.commands.registerCommand("as2fm.publish", () => this.publish()),
            sessions.onStopped((session) => void this.update(session)),
            sessions.onEnded((session) => {
                if (this.session === session) this.show(undefined, [], "");
            }),
        ];
    }

    getTreeItem(entry: Entry): vscode.TreeItem {
        const { Collapsed, Expanded, None } = vscode.TreeItemCollapsibleState;
        if ("hidden" in entry) {
            const text = vscode.l10n.t("Steps of the translation ({0})", entry.hidden.length);
            const item = new vscode.TreeItem(text, Collapsed);
            item.tooltip = vscode.l10n.t("Steps that nobody has written: of the clock, and within nodes of the tree.");
            return item;
        }
        const { choice, outcome } = entry;
        const hasOutcomes = outcome === undefined && choice.outcomes.length > 1;
        const { text, probability } = outcome ?? choice;
        // The probability comes first, because a narrow view cuts the end of the text.
        const label = probability < 1 ? `${percent(probability)}  ${text}` : text;
        const item = new vscode.TreeItem(label, hasOutcomes ? Expanded : None);
        item.tooltip = text;
        item.iconPath = new vscode.ThemeIcon(
            outcome || hasOutcomes ? "git-branch" : choice.isNext ? "debug-stackframe" : "circle-outline",
        );
        item.command = { command: CHOOSE, title: vscode.l10n.t("Take This Step"), arguments: [{ choice, outcome }] };
        return item;
    }

    /** `TreeView.reveal` requires this method. */
    getParent(entry: Entry): Entry | undefined {
        if ("hidden" in entry || !entry.outcome) return undefined;
        return this.entries.find((other) => "choice" in other && other.choice === entry.choice);
    }

    getChildren(entry?: Entry): Entry[] {
        if (entry === undefined) return [...this.entries];
        if ("hidden" in entry) return [...entry.hidden];
        if (entry.outcome || entry.choice.outcomes.length < 2) return [];
        return entry.choice.outcomes.map((outcome) => ({ choice: entry.choice, outcome }));
    }

    dispose(): void {
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    private async update(session: vscode.DebugSession): Promise<void> {
        try {
            const choices = (await session.customRequest("choices")) as Choices;
            const time = choices.time === null ? "" : `, ${choices.time.toFixed(3)} s`;
            const origin = choices.isChanged
                ? vscode.l10n.t("changed by the user")
                : vscode.l10n.t("chosen by the user");
            const suffix = choices.isByHand ? `, ${origin}` : "";
            const description = `${vscode.l10n.t("step {0}", choices.step)}${time}${suffix}`;
            const entries = entriesOf(choices.choices);
            const end = choices.end === null ? "" : vscode.l10n.t("The run has ended: {0}.", choices.end);
            const messages = [choices.fault ?? "", end, verdict(choices)];
            this.show(session, entries, description, messages.filter((text) => text !== "").join(" "));
            await this.reveal(session);
        } catch (error) {
            this.log.debug(`no choices: ${String(error)}`);
        }
    }

    private show(
        session: vscode.DebugSession | undefined,
        entries: readonly Entry[],
        description: string,
        message = "",
    ): void {
        this.session = session;
        this.entries = entries;
        this.view.description = description;
        this.view.message = message;
        this.changed.fire(undefined);
    }

    /** Opens the view at the first stop of a session. */
    private async reveal(session: vscode.DebugSession): Promise<void> {
        const [first] = this.entries;
        if (first === undefined || this.revealed === session) return;
        this.revealed = session;
        if (!this.view.visible) await this.view.reveal(first, { select: false, focus: false });
    }

    private async choose({ choice, outcome }: ChoiceEntry): Promise<void> {
        const drawn = outcome === undefined ? {} : { outcome: outcome.number };
        await this.sessions.request("choose", { choice: choice.number, ...drawn });
    }

    private async goToStep(): Promise<void> {
        const prompt = vscode.l10n.t("Go to the state after this number of steps");
        const isNumber = (text: string) => (/^\d+$/.test(text) ? undefined : vscode.l10n.t("a number of steps"));
        const text = await vscode.window.showInputBox({ prompt, validateInput: isNumber });
        if (text !== undefined) await this.sessions.request("goToStep", { step: Number(text) });
    }

    /** Let the user choose an event and its fields, and send the event. */
    private async publish(): Promise<void> {
        const answer = (await this.sessions.request("events", {})) as
            { readonly events: readonly Sendable[] } | undefined;
        if (!answer) return;
        const items = answer.events.map((sendable) => ({
            label: sendable.text,
            description: sendable.isFree
                ? sendable.fields
                : vscode.l10n.t("the previous event has not been received yet"),
            sendable,
        }));
        const placeHolder = vscode.l10n.t("Publish a message, or call a service");
        const picked = await vscode.window.showQuickPick(items, { placeHolder, matchOnDescription: true });
        if (!picked) return;
        const { event, fields, text } = picked.sendable;
        const prompt = vscode.l10n.t(
            "The fields of {0}; after this change, the run does not show the behaviour of the model",
            text,
        );
        const written = fields === "{}" ? fields : await vscode.window.showInputBox({ prompt, value: fields });
        if (written !== undefined) await this.sessions.request("publish", { event, fields: written });
    }
}

/** The choices of a person and the next step; below them, the steps of the translation. */
function entriesOf(choices: readonly Choice[]): readonly Entry[] {
    const entries = choices.map((choice) => ({ choice }));
    const hidden = entries.filter(({ choice }) => choice.isOfTranslation && !choice.isNext);
    const shown = entries.filter((entry) => !hidden.includes(entry));
    return hidden.length === 0 ? shown : [...shown, { hidden }];
}

/** The verdict on the property of the run, in its current state. */
function verdict({ property, verdicts }: Choices): string {
    const status = verdicts[property];
    if (status === "passed") return vscode.l10n.t("The property {0} holds in this run.", property);
    if (status === "failed") return vscode.l10n.t("The property {0} does not hold in this run.", property);
    return status === undefined ? "" : vscode.l10n.t("The property {0} is not decided yet.", property);
}

function percent(probability: number): string {
    return `${Number((probability * 100).toPrecision(3))} %`;
}
