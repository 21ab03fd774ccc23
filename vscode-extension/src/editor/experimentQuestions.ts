// SPDX-License-Identifier: Apache-2.0
/** Asks which parameters of a system get which values, which properties are computed, and what is expected of them. */

import * as path from "node:path";
import * as vscode from "vscode";
import { experimentForm, newParameter, type AskedNumber, type AskedParameter, type ExperimentForm } from "../protocol";
import type { LanguageServer } from "./server";

/** What is run: a file of arguments, or the arguments with which the command is called. */
export interface Experiment {
    readonly title: string;
    readonly arguments: readonly string[];
}

const COMPARISON = /^\s*(>=|<=|==|>|<)\s*\S+\s*$/;

/** The experiment that the user wants; undefined if the user cancels. `parameter` is one that is varied. */
export async function askForExperiment(
    server: LanguageServer,
    system: string,
    parameter: string | undefined,
): Promise<Experiment | undefined> {
    const { client } = server;
    let form = await server.ask(experimentForm, { textDocument: { uri: system } });
    if (!client || !form) return undefined;
    if (form.properties.length === 0) {
        void vscode.window.showInformationMessage(vscode.l10n.t("The system has no property. Create one first."));
        return undefined;
    }
    if (form.parameters.length === 0) {
        form = await withNewParameter(server, system, form.numbers);
        if (!form) return undefined;
    }
    const varied = await chooseParameters(form.parameters, parameter);
    if (!varied || varied.length === 0) return undefined;
    const sets: string[] = [];
    for (const chosen of varied) {
        const values = await chooseValues(chosen);
        if (values === undefined) return undefined;
        sets.push(`--set=${chosen.name}=${values}`);
    }
    const asked = await chooseProperties(form);
    const [first] = varied;
    if (!asked || !first) return undefined;
    const file = client.protocol2CodeConverter.asUri(system).fsPath;
    return { title: path.basename(file), arguments: [file, ...sets, ...asked(first.name)] };
}

async function chooseParameters(
    parameters: readonly AskedParameter[],
    picked: string | undefined,
): Promise<readonly AskedParameter[] | undefined> {
    if (parameters.length === 1) return parameters;
    const items = parameters.map((parameter) => ({
        label: parameter.name,
        description: `${parameter.value}${parameter.limits === "" ? "" : ` (${parameter.limits})`}`,
        picked: parameter.name === picked,
        parameter,
    }));
    const title = vscode.l10n.t("Which parameters get several values?");
    const chosen = await vscode.window.showQuickPick(items, { title, canPickMany: true });
    return chosen?.map((item) => item.parameter);
}

function chooseValues({ name, value, proposed, limits }: AskedParameter): Thenable<string | undefined> {
    const now = limits === "" ? value : `${value}; ${limits}`;
    return vscode.window.showInputBox({
        title: vscode.l10n.t("Values of {0} (now {1})", name, now),
        prompt: vscode.l10n.t("From:to:step, such as 20:200:20, or a list, such as 0,0.01,0.05"),
        value: proposed,
        validateInput: (text) => (text.trim() === "" ? vscode.l10n.t("At least one value") : undefined),
    });
}

/** The arguments about properties. With one property, it is asked which values of the parameter are enough. */
async function chooseProperties({
    properties,
}: ExperimentForm): Promise<((parameter: string) => string[]) | undefined> {
    const items = properties.map(({ name, comment, expected }) => ({ label: name, detail: comment, name, expected }));
    const title = vscode.l10n.t("Which properties are computed?");
    const options = { title, canPickMany: true, matchOnDetail: true } as const;
    const chosen = items.length === 1 ? items : await vscode.window.showQuickPick(items, options);
    const [first, ...others] = chosen ?? [];
    if (!first) return undefined;
    if (others.length > 0) return () => [first, ...others].map(({ name }) => `--property=${name}`);
    const expected = await vscode.window.showInputBox({
        title: vscode.l10n.t("Which value of {0} is enough?", first.name),
        prompt: vscode.l10n.t("A comparison, such as >= 0.95; leave empty to see only the values"),
        value: first.expected,
        validateInput: (text) =>
            text.trim() === "" || COMPARISON.test(text) ? undefined : vscode.l10n.t("A comparison, such as >= 0.95"),
    });
    if (expected === undefined) return undefined;
    if (expected.trim() === "") return () => [`--property=${first.name}`];
    return (parameter) => [`--find=${parameter}`, `--meets=${first.name} ${expected.trim()}`];
}

/** The system has no parameters: one of its numbers becomes one. */
async function withNewParameter(
    server: LanguageServer,
    system: string,
    numbers: readonly AskedNumber[],
): Promise<ExperimentForm | undefined> {
    const items = numbers.map((number) => ({ label: number.text, description: number.place, number }));
    const title = vscode.l10n.t("The system has no parameter yet. Which number is varied?");
    const chosen = await vscode.window.showQuickPick(items, { title, matchOnDescription: true });
    if (!chosen) return undefined;
    const { uri, offset } = chosen.number;
    const made = await server.ask(newParameter, { textDocument: { uri }, offset });
    const edit = made && (await server.client?.protocol2CodeConverter.asWorkspaceEdit(made));
    if (!edit || !(await vscode.workspace.applyEdit(edit))) {
        const text = vscode.l10n.t("The file belongs to several systems, so the number cannot become a parameter.");
        void vscode.window.showInformationMessage(text);
        return undefined;
    }
    for (const [file] of edit.entries()) await (await vscode.workspace.openTextDocument(file)).save();
    return server.ask(experimentForm, { textDocument: { uri: system } });
}
