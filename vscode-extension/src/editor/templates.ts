// SPDX-License-Identifier: Apache-2.0
/** Creates new systems, machines and files for CI, and the sample of the walkthrough. */

import * as vscode from "vscode";
import { thisHost } from "../server/host";
import type { LanguageServer } from "./server";

/** Create a small working system with `as2fm-lsp init`. */
export async function newSystem(server: LanguageServer): Promise<void> {
    const { state } = server;
    if (state.kind !== "running") return;
    const folder = await newFolder(vscode.l10n.t("Folder of the new system"), "my_robot");
    if (!folder) return;
    const ended = await thisHost.run(state.server.command, [...state.server.args, "init", folder.fsPath]);
    if (ended.status !== 0) {
        void vscode.window.showErrorMessage((ended.err || ended.out).trim());
        return;
    }
    await vscode.window.showTextDocument(vscode.Uri.joinPath(folder, "main.xml"));
}

/** Create a machine from a template, and open it. */
export async function newMachine(context: vscode.ExtensionContext, kind: "node" | "plugin"): Promise<void> {
    const folder = vscode.workspace.workspaceFolders?.[0]?.uri;
    if (!folder) return;
    const title =
        kind === "node" ? vscode.l10n.t("Name of the new node") : vscode.l10n.t("Name of the new behavior tree plugin");
    const name = await vscode.window.showInputBox({
        title,
        value: kind === "node" ? "MyNode" : "MyAction",
        validateInput: (value) =>
            /^[A-Za-z_]\w*$/.test(value)
                ? undefined
                : vscode.l10n.t("Letters, digits and underscores, beginning with a letter"),
    });
    if (name === undefined) return;
    const file = vscode.Uri.joinPath(folder, kind === "node" ? "nodes" : "plugins", `${fileName(name)}.ascxml`);
    if (await exists(file)) {
        void vscode.window.showErrorMessage(
            vscode.l10n.t("{0} already exists.", vscode.workspace.asRelativePath(file)),
        );
        return;
    }
    const template = vscode.Uri.joinPath(context.extensionUri, "dist", "templates", `${kind}.ascxml`);
    const text = new TextDecoder().decode(await vscode.workspace.fs.readFile(template)).replaceAll("NAME", name);
    await vscode.workspace.fs.writeFile(file, new TextEncoder().encode(text));
    await vscode.window.showTextDocument(file);
}

/** Create a workflow that runs `as2fm-lsp --check` at each push. */
export async function addToCi(context: vscode.ExtensionContext): Promise<void> {
    const folder = vscode.workspace.workspaceFolders?.[0]?.uri;
    if (!folder) return;
    const items = [
        { label: "GitHub", path: ".github/workflows/as2fm.yml", template: "github.yml" },
        { label: "GitLab", path: ".gitlab-ci.yml", template: "gitlab.yml" },
    ];
    const picked = await vscode.window.showQuickPick(items, { title: vscode.l10n.t("Select the CI provider") });
    if (!picked) return;
    const file = vscode.Uri.joinPath(folder, picked.path);
    const template = vscode.Uri.joinPath(context.extensionUri, "dist", "ci", picked.template);
    if (await exists(file)) {
        // Do not overwrite the user's file: show the template, so that its lines can be copied.
        await vscode.window.showTextDocument(template, { preview: true });
        return;
    }
    await vscode.workspace.fs.writeFile(file, await vscode.workspace.fs.readFile(template));
    await vscode.window.showTextDocument(file);
}

/** Create a copy of the sample system, which contains one error. */
export async function openSample(context: vscode.ExtensionContext): Promise<void> {
    const folder = await newFolder(vscode.l10n.t("Folder for the sample"), "delivery_robot");
    if (!folder) return;
    if (await exists(folder)) {
        const files = await vscode.workspace.fs.readDirectory(folder);
        if (files.length > 0) {
            void vscode.window.showErrorMessage(vscode.l10n.t("{0} is not empty.", folder.fsPath));
            return;
        }
    }
    const sample = vscode.Uri.joinPath(context.extensionUri, "dist", "sample");
    await vscode.workspace.fs.copy(sample, folder, { overwrite: true });
    const inside = vscode.workspace.getWorkspaceFolder(folder) !== undefined;
    if (!inside) await vscode.commands.executeCommand("vscode.openFolder", folder, { forceNewWindow: false });
    else await vscode.window.showTextDocument(vscode.Uri.joinPath(folder, "nodes", "battery.ascxml"));
}

async function newFolder(title: string, name: string): Promise<vscode.Uri | undefined> {
    const base = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath ?? thisHome();
    const value = `${base}/${name}`;
    const chosen = await vscode.window.showInputBox({ title, value, valueSelection: [base.length + 1, value.length] });
    return chosen === undefined || chosen.trim() === "" ? undefined : vscode.Uri.file(chosen.trim());
}

function thisHome(): string {
    return process.env["HOME"] ?? process.env["USERPROFILE"] ?? "";
}

/** `MyNode` -> `my_node` */
function fileName(name: string): string {
    return name.replace(/([a-z0-9])([A-Z])/g, "$1_$2").toLowerCase();
}

async function exists(uri: vscode.Uri): Promise<boolean> {
    try {
        await vscode.workspace.fs.stat(uri);
        return true;
    } catch {
        return false;
    }
}
