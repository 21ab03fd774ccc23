// SPDX-License-Identifier: Apache-2.0
/** The active interpreters of the extensions for Python. These extensions and their functions are optional. */

import * as vscode from "vscode";

/** The part of the API of `ms-python.python` that is used. */
interface PythonApi {
    readonly environments?: {
        getActiveEnvironmentPath(resource?: vscode.Uri): { readonly path: string };
        resolveEnvironment(
            environment: unknown,
        ): Promise<{ readonly executable: { readonly uri?: vscode.Uri } } | undefined>;
        readonly onDidChangeActiveEnvironmentPath: vscode.Event<unknown>;
    };
}

/** The part of the API of `ms-python.vscode-python-envs` that is used. */
interface EnvironmentsApi {
    getEnvironment?(
        scope: vscode.Uri | undefined,
    ): Promise<{ readonly execInfo?: { readonly run?: { readonly executable?: string } } } | undefined>;
    readonly onDidChangeEnvironment?: vscode.Event<unknown>;
}

const PYTHON = "ms-python.python";
const ENVIRONMENTS = "ms-python.vscode-python-envs";

export async function activeInterpreters(log: vscode.LogOutputChannel): Promise<string[]> {
    const folder = vscode.workspace.workspaceFolders?.[0]?.uri;
    const paths: (string | undefined)[] = [];
    try {
        const environments = await api<EnvironmentsApi>(ENVIRONMENTS);
        paths.push((await environments?.getEnvironment?.(folder))?.execInfo?.run?.executable);
        const python = (await api<PythonApi>(PYTHON))?.environments;
        if (python) {
            const environment = await python.resolveEnvironment(python.getActiveEnvironmentPath(folder));
            paths.push(environment?.executable.uri?.fsPath);
        }
    } catch (error) {
        log.warn(`An extension for Python cannot be asked for its interpreter: ${String(error)}`);
    }
    return [...new Set(paths.filter((path): path is string => typeof path === "string" && path !== ""))];
}

/** Call a listener when another interpreter becomes the active one. */
export async function onInterpreterChange(listener: () => void): Promise<vscode.Disposable[]> {
    const environments = await api<EnvironmentsApi>(ENVIRONMENTS).catch(() => undefined);
    const python = await api<PythonApi>(PYTHON).catch(() => undefined);
    const events = [environments?.onDidChangeEnvironment, python?.environments?.onDidChangeActiveEnvironmentPath];
    return events.filter((event) => event !== undefined).map((event) => event(listener));
}

async function api<T>(id: string): Promise<T | undefined> {
    const extension = vscode.extensions.getExtension<T>(id);
    return extension && (await extension.activate());
}
