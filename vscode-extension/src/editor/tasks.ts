// SPDX-License-Identifier: Apache-2.0
/** Provides `as2fm-lsp --check` and `translate` as tasks, which run the same installation as the editor. */

import * as vscode from "vscode";
import { safeVariables } from "../server/surroundings";
import type { LanguageServer } from "./server";

export interface Definition extends vscode.TaskDefinition {
    readonly command: "check" | "translate";
    readonly path?: string;
    readonly arguments?: readonly string[];
}

export class Tasks implements vscode.TaskProvider {
    static readonly type = "as2fm";

    constructor(private readonly server: LanguageServer) {}

    provideTasks(): vscode.Task[] {
        const folders = vscode.workspace.workspaceFolders ?? [];
        return folders.flatMap((folder) => this.task({ type: Tasks.type, command: "check" }, folder) ?? []);
    }

    resolveTask(task: vscode.Task): vscode.Task | undefined {
        const definition = task.definition as Definition;
        const folder = typeof task.scope === "object" ? task.scope : vscode.workspace.workspaceFolders?.[0];
        return folder && this.task(definition, folder);
    }

    /** The task of a definition; undefined while no server runs, and in an untrusted workspace. */
    task(definition: Definition, folder: vscode.WorkspaceFolder): vscode.Task | undefined {
        const { state } = this.server;
        if (state.kind !== "running" || !["check", "translate"].includes(definition.command)) return undefined;
        if (!vscode.workspace.isTrusted) return undefined;
        const what = definition.command === "check" ? ["--check"] : ["translate"];
        const path = definition.path ?? (definition.command === "check" ? "." : undefined);
        if (path === undefined) return undefined;
        const args = [...state.server.args, ...what, path, ...(definition.arguments ?? [])];
        const execution = new vscode.ProcessExecution(state.server.command, args, {
            // The task shows paths relative to the folder. The server's Python imports no modules from there.
            cwd: folder.uri.fsPath,
            env: safeVariables(process.env),
        });
        const name = `${definition.command} ${path}`;
        const task = new vscode.Task(definition, folder, name, "AS2FM", execution, "$as2fm");
        if (definition.command === "check") task.group = vscode.TaskGroup.Test;
        task.presentationOptions = { clear: true, reveal: vscode.TaskRevealKind.Always };
        return task;
    }
}
