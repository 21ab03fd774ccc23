// SPDX-License-Identifier: Apache-2.0
/** Asks which parameters of a system get which values, which properties are computed, and what is expected of them. */

import * as path from "node:path";
import * as vscode from "vscode";
import { experimentForm, newParameter, type AskedParameter, type ExperimentForm } from "../protocol";
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
    const declared = await chooseParameters(form, parameter);
    if (!declared) return undefined;
    let { varied } = declared;
    if (declared.another) {
        const before = new Set(form.parameters.map(({ name }) => name));
        form = await withNewParameter(server, system, form);
        if (!form) return undefined;
        varied = [...varied, ...form.parameters.filter(({ name }) => !before.has(name))];
    }
    if (varied.length === 0) return undefined;
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

/** What is varied: parameters of the system, and `another` number that becomes one. */
interface Varied {
    readonly varied: readonly AskedParameter[];
    readonly another: boolean;
}

async function chooseParameters(
    { parameters, numbers }: ExperimentForm,
    picked: string | undefined,
): Promise<Varied | undefined> {
    if (parameters.length === 0) return { varied: [], another: true };
    // From the lens of the only parameter, nothing is left to choose.
    if (parameters.length === 1 && (numbers.length === 0 || picked !== undefined)) {
        return { varied: parameters, another: false };
    }
    const listed = parameters.map((parameter) => ({
        label: parameter.name,
        description: `${parameter.value}${parameter.limits === "" ? "" : ` (${parameter.limits})`}`,
        picked: parameters.length === 1 || parameter.name === picked,
        parameter,
    }));
    const another = {
        label: vscode.l10n.t("Another number"),
        description: vscode.l10n.t("It becomes a parameter"),
        picked: false,
        parameter: undefined,
    };
    const items = numbers.length > 0 ? [...listed, another] : listed;
    const title = vscode.l10n.t("Which parameters get several values?");
    const chosen = await vscode.window.showQuickPick(items, { title, canPickMany: true });
    if (!chosen) return undefined;
    const varied = chosen.flatMap(({ parameter }) => (parameter ? [parameter] : []));
    return { varied, another: varied.length < chosen.length };
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

/** One of the numbers of the system becomes a parameter. */
async function withNewParameter(
    server: LanguageServer,
    system: string,
    { parameters, numbers }: ExperimentForm,
): Promise<ExperimentForm | undefined> {
    const items = numbers.map((number) => ({
        label: number.text,
        description: number.place,
        detail: number.comment,
        number,
    }));
    const title =
        parameters.length === 0
            ? vscode.l10n.t("The system has no parameter yet. Which number is varied?")
            : vscode.l10n.t("Which number is varied?");
    const options = { title, matchOnDescription: true, matchOnDetail: true } as const;
    const chosen = await vscode.window.showQuickPick(items, options);
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
