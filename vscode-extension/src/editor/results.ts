// SPDX-License-Identifier: Apache-2.0
/**
 * The view with the properties of the workspace as sentences, each with its result. All words about results come from
 * the server.
 */

import * as vscode from "vscode";
import { SHOW_FIRST_ERROR, VERIFY, type Property, type ResultView, type VerifiableSystem } from "../protocol";
import { shortened } from "../verification/shortened";
import { COMPARE_RUNS, SHOW_COUNTEREXAMPLE, SHOW_WITNESS } from "./client";
import { jump } from "./pictureSource";
import type { Asked, PropertyTests } from "./tests";
import { isTrusted } from "./trust";

const VIEW = "as2fm.results";
const OPEN = "as2fm.results.open";

interface SystemRow {
    readonly kind: "system";
    readonly system: VerifiableSystem;
}

/** A property; it is also what its commands receive. `trace` is the one that contradicts its expectation. */
interface PropertyRow extends Asked {
    readonly kind: "property";
    readonly shown: Property;
}

interface Line {
    readonly kind: "line";
    readonly text: string;
    readonly icon: string;
    readonly command?: vscode.Command;
}

type Row = SystemRow | PropertyRow | Line;

/** The maximum number of characters of a sentence, so that its result is visible beside it. */
const MAX_SENTENCE = 80;

/** The icon of what could not be verified. */
const ERROR = ["issues", "testing.iconErrored"] as const;

const ICONS: Readonly<Record<ResultView["mark"], readonly [icon: string, color: string]>> = {
    passed: ["pass", "testing.iconPassed"],
    failed: ["error", "testing.iconFailed"],
    uniform: ["pass", "charts.yellow"],
    doubtful: ["warning", "list.warningForeground"],
    undecided: ["question", "charts.yellow"],
    open: ["circle-large-outline", "foreground"],
};

export class ResultsView implements vscode.Disposable, vscode.TreeDataProvider<Row> {
    private readonly changed = new vscode.EventEmitter<undefined>();
    private readonly view: vscode.TreeView<Row>;
    private readonly subscriptions: { dispose(): unknown }[];
    private systems: readonly VerifiableSystem[] = [];
    private shown = "";

    readonly onDidChangeTreeData = this.changed.event;

    constructor(private readonly tests: PropertyTests) {
        this.view = vscode.window.createTreeView<Row>(VIEW, { treeDataProvider: this, showCollapseAll: true });
        this.subscriptions = [
            this.changed,
            this.view,
            tests.onSystems((systems) => {
                this.show(systems);
            }),
            tests.onVerifying(() => {
                this.changed.fire(undefined);
            }),
            // The names of the systems contain that of their folder if there are several.
            vscode.workspace.onDidChangeWorkspaceFolders(() => {
                this.changed.fire(undefined);
            }),
            vscode.commands.registerCommand(OPEN, ({ shown: { uri, range } }: PropertyRow) =>
                jump({ uri, range }, false, true),
            ),
            vscode.commands.registerCommand("as2fm.results.verify", (row?: SystemRow | PropertyRow) =>
                this.verify(row),
            ),
            vscode.commands.registerCommand("as2fm.results.verifyMore", (row: PropertyRow) =>
                isTrusted() ? tests.verifyMore(row, row.shown.view?.epsilon ?? 0) : undefined,
            ),
        ];
    }

    getTreeItem(row: Row): vscode.TreeItem {
        const { Collapsed, Expanded, None } = vscode.TreeItemCollapsibleState;
        if (row.kind === "line") {
            const item = new vscode.TreeItem(row.text, None);
            item.iconPath = new vscode.ThemeIcon(row.icon);
            item.tooltip = row.text;
            if (row.command) item.command = row.command;
            return item;
        }
        if (row.kind === "system") {
            const uri = vscode.Uri.parse(row.system.uri);
            const item = new vscode.TreeItem(vscode.workspace.asRelativePath(uri), Expanded);
            item.id = row.system.uri;
            item.contextValue = "system";
            item.iconPath = new vscode.ThemeIcon("symbol-namespace");
            const obstacles = this.tests.obstaclesOf(row.system.uri);
            if (obstacles.length > 0) {
                item.description = vscode.l10n.t("not verified, errors: {0}", obstacles.length);
                item.tooltip = obstacles.join("\n");
                const [icon, color] = ERROR;
                item.iconPath = new vscode.ThemeIcon(icon, new vscode.ThemeColor(color));
                item.command = { command: SHOW_FIRST_ERROR, title: item.description, arguments: [row.system.uri] };
            }
            return item;
        }
        const { name, comment, view, stale } = row.shown;
        const sentence = sentenceOf(row);
        const obstacles = this.obstaclesOf(row);
        const isOpened = view !== undefined || obstacles.length > 0;
        const item = new vscode.TreeItem(shortened(sentence, MAX_SENTENCE), isOpened ? Collapsed : None);
        item.id = `${row.system}#${name}`;
        const isRunning = this.tests.isBeingVerified(row);
        const unknown = obstacles.length > 0 ? vscode.l10n.t("cannot be verified") : vscode.l10n.t("not verified");
        const known = view?.words ?? unknown;
        const words = isRunning ? vscode.l10n.t("Verifying…") : known;
        // The result is visible also if the name is cut off.
        item.description = comment === "" ? words : `${words} · ${name}`;
        item.tooltip = [sentence, ...(view ? [view.since, ...view.lines] : [words, ...obstacles])]
            .filter((line) => line)
            .join("\n");
        const noResult = obstacles.length > 0 ? ERROR : (["circle-outline", "disabledForeground"] as const);
        const [icon, color] = view ? ICONS[view.mark] : noResult;
        item.iconPath = isRunning
            ? new vscode.ThemeIcon("loading~spin")
            : new vscode.ThemeIcon(icon, new vscode.ThemeColor(stale ? "disabledForeground" : color));
        item.contextValue = contextOf(view);
        item.command = { command: OPEN, title: vscode.l10n.t("Go to Text"), arguments: [row] };
        item.accessibilityInformation = { label: `${sentence} ${item.description}` };
        return item;
    }

    getChildren(row?: Row): Row[] {
        if (row === undefined) return this.systems.map((system) => ({ kind: "system", system }));
        if (row.kind === "system") {
            const system = row.system.uri;
            return row.system.properties.map((shown) => {
                const { seed = null, trace = null } = shown.view ?? {};
                const run = seed === null || trace === null ? {} : { trace: { seed, trace } };
                return { kind: "property", system, property: shown.name, shown, ...run };
            });
        }
        if (row.kind !== "property") return [];
        if (row.shown.view) return linesOf(row, row.shown.view);
        return this.obstaclesOf(row).map((text) => ({ kind: "line", text, icon: "blank" }));
    }

    /** Why a property without a result was not verified. */
    private obstaclesOf({ system, property, shown }: PropertyRow): readonly string[] {
        return shown.view ? [] : this.tests.obstaclesOf(system, property);
    }

    dispose(): void {
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    private show(systems: readonly VerifiableSystem[]): void {
        const shown = JSON.stringify(systems);
        if (shown === this.shown) return;
        this.shown = shown;
        this.systems = systems;
        const all = systems.flatMap(({ properties }) => properties);
        const failed = all.filter(({ view }) => view?.mark === "failed").length;
        const none = { value: 0, tooltip: "" };
        this.view.badge = failed === 0 ? none : { value: failed, tooltip: vscode.l10n.t("{0} not met", failed) };
        void vscode.commands.executeCommand("setContext", "as2fm.hasProperties", all.length > 0);
        this.changed.fire(undefined);
    }

    /** Verify a property, the properties of a system, or all. */
    private async verify(row: SystemRow | PropertyRow | undefined): Promise<void> {
        if (!isTrusted()) return;
        if (row?.kind === "property") await this.tests.verify(row.system, [row.property]);
        else
            for (const { uri } of row ? [row.system] : this.systems)
                await vscode.commands.executeCommand(VERIFY, uri, []);
    }
}

/** Which commands apply to a property, for the menus. */
function contextOf(view: ResultView | undefined): string {
    const has = {
        counterexample: view?.counterexample,
        witness: view?.witness,
        expectation: view?.canSetExpectation,
        more: (view?.epsilon ?? 0) > 0,
    };
    return ["property", ...Object.entries(has).flatMap(([name, applies]) => (applies ? [name] : []))].join(" ");
}

/** What a property requires, or its name if its file does not say so. */
function sentenceOf({ shown: { name, comment } }: PropertyRow): string {
    return comment === "" ? name : comment;
}

function linesOf(row: PropertyRow, view: ResultView): Line[] {
    const { system, property } = row;
    const sentence = sentenceOf(row);
    const lines: Line[] = view.lines.map((text) => ({ kind: "line", text, icon: "blank" }));
    if (sentence.length > MAX_SENTENCE) lines.unshift({ kind: "line", text: sentence, icon: "quote" });
    if (view.since !== "") lines.unshift({ kind: "line", text: view.since, icon: "history" });
    const shows = (command: string, title: string, icon: string): Line => ({
        kind: "line",
        text: title,
        icon,
        command: { command, title, arguments: [system, property] },
    });
    if (view.counterexample)
        lines.push(shows(SHOW_COUNTEREXAMPLE, vscode.l10n.t("Show Counterexample"), "debug-stackframe"));
    if (view.counterexample && view.witness)
        lines.push(shows(COMPARE_RUNS, vscode.l10n.t("Compare with a Passing Run"), "git-compare"));
    if (view.witness) lines.push(shows(SHOW_WITNESS, vscode.l10n.t("Show Witness"), "debug-stackframe-dot"));
    return lines;
}
