// SPDX-License-Identifier: Apache-2.0
/** The view beside a counterexample with the whole state of the system at its step. Changed values are marked. */

import * as vscode from "vscode";
import type { StateRow } from "../protocol";

const VIEW = "as2fm.traceState";

export class TraceStateView implements vscode.Disposable, vscode.TreeDataProvider<StateRow> {
    private readonly changed = new vscode.EventEmitter<undefined>();
    private readonly view: vscode.TreeView<StateRow>;
    private rows: readonly StateRow[] = [];
    /** What the user has opened or closed, by the names of groups; it is kept from step to step. */
    private readonly open = new Map<string, boolean>();

    readonly onDidChangeTreeData = this.changed.event;

    constructor() {
        this.view = vscode.window.createTreeView<StateRow>(VIEW, { treeDataProvider: this, showCollapseAll: true });
        this.view.onDidExpandElement(({ element }) => this.open.set(element.name, true));
        this.view.onDidCollapseElement(({ element }) => this.open.set(element.name, false));
    }

    show(rows: readonly StateRow[], description: string): void {
        this.rows = rows;
        this.view.description = description;
        this.changed.fire(undefined);
    }

    getTreeItem(row: StateRow): vscode.TreeItem {
        const { Collapsed, Expanded, None } = vscode.TreeItemCollapsibleState;
        const isOpen = this.open.get(row.name) ?? row.hasChanged;
        const item = new vscode.TreeItem(row.name, row.rows.length === 0 ? None : isOpen ? Expanded : Collapsed);
        // A group that opens or closes is another entry: VS Code keeps the state of entries that it knows.
        if (row.rows.length > 0) item.id = `${row.name}:${isOpen}`;
        const was = row.before === null ? "" : vscode.l10n.t("was {0}", row.before === "" ? "–" : row.before);
        item.description = [row.value, was].filter((text) => text !== "").join("  ← ");
        item.tooltip = [row.name, item.description].join(": ");
        const color = new vscode.ThemeColor("gitDecoration.modifiedResourceForeground");
        item.iconPath = row.hasChanged
            ? new vscode.ThemeIcon("diff-modified", color)
            : new vscode.ThemeIcon(row.rows.length > 0 ? "symbol-namespace" : "symbol-variable");
        item.accessibilityInformation = {
            label: [row.name, item.description, row.hasChanged ? vscode.l10n.t("changed") : ""].join(" "),
        };
        return item;
    }

    getChildren(row?: StateRow): StateRow[] {
        return [...(row === undefined ? this.rows : row.rows)];
    }

    dispose(): void {
        this.changed.dispose();
        this.view.dispose();
    }
}
