// SPDX-License-Identifier: Apache-2.0
import * as vscode from "vscode";
import type { Location, Position } from "vscode-languageserver-protocol";
import { migrate, TRANSLATE, type Property } from "../protocol";
import { thisHost } from "../server/host";
import { pythons } from "../server/python";
import {
    COMPARE_RUNS,
    DEBUG_COUNTEREXAMPLE,
    DEBUG_MODEL,
    EDIT_MOCKS,
    EXPERIMENT,
    SET_EXPECTATION,
    SHOW_COUNTEREXAMPLE,
    SHOW_REFERENCES,
    SHOW_WITNESS,
} from "./client";
import type { Activation } from "./activation";
import { chosenProperty } from "./chosenProperty";
import { compareRuns } from "./compareRuns";
import type { Counterexamples } from "./counterexamples";
import type { Debugging, Trace } from "./debugging";
import type { Documents } from "./documents";
import { EXPERIMENT_FILE, type Experiments } from "./experiments";
import type { JaniView } from "./janiView";
import { chooseExpectation } from "./expectation";
import { newProperty } from "./newProperty";
import type { PicturePanels } from "./picturePanels";
import type { PlainScxmlPreview } from "./plainScxml";
import { untrustedFolders, type LanguageServer } from "./server";
import { done } from "./steps";
import type { StatusItem } from "./statusItem";
import { Tasks } from "./tasks";
import type { Asked, PropertyTests } from "./tests";
import { newMachine, newSystem, openSample, addToCi } from "./templates";
import { isTrusted } from "./trust";
import { tellOrigin } from "./wording";

export interface Parts {
    readonly context: vscode.ExtensionContext;
    readonly log: vscode.LogOutputChannel;
    readonly server: LanguageServer;
    readonly activation: Activation;
    readonly status: StatusItem;
    readonly documents: Documents;
    readonly tasks: Tasks;
    readonly plain: PlainScxmlPreview;
    readonly jani: JaniView;
    readonly pictures: PicturePanels;
    readonly tests: PropertyTests;
    readonly counterexamples: Counterexamples;
    readonly debugging: Debugging;
    readonly experiments: Experiments;
}

export function registerCommands(parts: Parts): void {
    const { context, log, server, status, pictures } = parts;
    const commands: Record<string, () => unknown> = {
        translate: trusted(() => translate(parts)),
        verifySystem: trusted(() => verify(parts)),
        debugSystem: trusted(() => debugSystem(parts)),
        showJani: () => withEditor((editor) => parts.jani.open(editor.document.uri, vscode.ViewColumn.Active)),
        showPlainScxml: () => withEditor((editor) => parts.plain.open(editor)),
        showMachine: () => withEditor((editor) => pictures.open("machine", editor.document.uri)),
        showTree: () => withEditor((editor) => showOfSystem(parts, "tree", editor.document)),
        showMachines: () => withEditor((editor) => showOfSystem(parts, "system", editor.document)),
        showRosGraph: () => withEditor((editor) => showOfSystem(parts, "ros", editor.document)),
        checkWorkspace: trusted(() => checkWorkspace(parts)),
        newSystem: trusted(() => newSystem(server)),
        newNode: trusted(() => newMachine(context, "node")),
        newPlugin: trusted(() => newMachine(context, "plugin")),
        newProperty: trusted(() => createProperty(parts)),
        migrate: trusted(() => migrateSystem(parts)),
        addToCi: trusted(() => addToCi(context)),
        openSample: trusted(() => openSample(context)),
        restart: () => server.start(),
        install: () => server.install(),
        selectInterpreter: () => selectInterpreter(),
        showLog: () => {
            log.show();
        },
        showVersions: () => showVersions(parts),
        showStatus: () => status.choose(),
        openServerSetting: () => vscode.commands.executeCommand("workbench.action.openSettings", "as2fm.server.path"),
        getPython: () => vscode.env.openExternal(vscode.Uri.parse("https://www.python.org/downloads/")),
    };
    context.subscriptions.push(
        vscode.commands.registerCommand(SHOW_REFERENCES, (uri: string, position: Position, places: Location[]) => {
            const convert = server.client?.protocol2CodeConverter;
            if (!convert) return undefined;
            const [at, locations] = [convert.asPosition(position), places.map((place) => convert.asLocation(place))];
            return vscode.commands.executeCommand("editor.action.showReferences", convert.asUri(uri), at, locations);
        }),
    );
    type Of = string | vscode.TestItem | Asked | undefined;
    /** The property that a lens, a message, a test or a row denotes; without one, in the palette, the user chooses. */
    const ofProperty = (of: Of, property: string, applies: (property: Property) => boolean, none: string) =>
        of === undefined ? chosenProperty(parts.tests.known, applies, none) : parts.tests.asked(of, property);
    const withCounterexample = (of: Of, property: string) =>
        ofProperty(
            of,
            property,
            ({ view }) => view?.counterexample === true,
            vscode.l10n.t("No property has a counterexample. Verify the properties first."),
        );
    context.subscriptions.push(
        vscode.commands.registerCommand(SHOW_COUNTEREXAMPLE, async (of: Of, property: string) => {
            const asked = await withCounterexample(of, property);
            if (asked) await parts.counterexamples.show(asked.system, asked.property);
        }),
        vscode.commands.registerCommand(SHOW_WITNESS, async (of: Of, property: string) => {
            const none = vscode.l10n.t("No property has a witness. Verify the properties first.");
            const asked = await ofProperty(of, property, ({ view }) => view?.witness === true, none);
            if (asked) await parts.counterexamples.show(asked.system, asked.property, true);
        }),
        vscode.commands.registerCommand(SET_EXPECTATION, async (of: Of, property: string) => {
            const none = vscode.l10n.t("There are no properties.");
            const asked = await ofProperty(of, property, () => true, none);
            if (!asked || !isTrusted()) return;
            if (await chooseExpectation(server, asked.system, asked.property)) await parts.tests.refresh();
        }),
        // From the command palette and the view of a counterexample, without arguments.
        vscode.commands.registerCommand(COMPARE_RUNS, async (of: Of, property: string) => {
            const { asked: shown } = parts.counterexamples;
            const asked = of === undefined ? shown : parts.tests.asked(of, property);
            if (asked && isTrusted()) await compareRuns(server, parts.debugging, asked);
        }),
        vscode.commands.registerCommand(DEBUG_COUNTEREXAMPLE, async (of: Of, property: string, trace?: Trace) => {
            const asked = await withCounterexample(of, property);
            const uri = asked && server.client?.protocol2CodeConverter.asUri(asked.system);
            if (uri) await parts.debugging.counterexample(uri, asked.property, asked.trace ?? trace);
        }),
    );
    context.subscriptions.push(
        vscode.commands.registerCommand(DEBUG_MODEL, async (model: string, attributes: object) => {
            // The debugger reads the files from the disk.
            await vscode.workspace.saveAll(false);
            const uri = server.client?.protocol2CodeConverter.asUri(model);
            return uri && parts.debugging.start(uri, attributes);
        }),
        // Called from a lens with a system or file, from the explorer with a file, from the palette without arguments.
        vscode.commands.registerCommand(EXPERIMENT, (of?: string | vscode.Uri, parameter?: unknown) => {
            parts.activation.need();
            return experiment(parts, of, typeof parameter === "string" ? parameter : undefined);
        }),
        vscode.commands.registerCommand(EDIT_MOCKS, (tree?: string) => {
            const active = vscode.window.activeTextEditor?.document.uri;
            const uri = tree === undefined ? active : server.client?.protocol2CodeConverter.asUri(tree);
            done("mocked");
            return uri && pictures.editMocks(uri);
        }),
    );
    for (const [name, run] of Object.entries(commands)) {
        const command = () => {
            parts.activation.need();
            return run();
        };
        context.subscriptions.push(vscode.commands.registerCommand(`as2fm.${name}`, command));
    }
}

/** Allow a command that writes files or starts programs only in a trusted workspace. */
function trusted(run: () => unknown): () => unknown {
    return () => (isTrusted() ? run() : undefined);
}

async function translate({ server, documents }: Parts): Promise<void> {
    const system = await documents.system(vscode.window.activeTextEditor?.document);
    if (system) await vscode.commands.executeCommand(TRANSLATE, server.client?.code2ProtocolConverter.asUri(system));
}

async function verify({ debugging, server, tests }: Parts): Promise<void> {
    const system = await debugging.program(vscode.window.activeTextEditor?.document);
    const uri = system && server.client?.code2ProtocolConverter.asUri(system);
    if (uri === undefined) return;
    // Focus the view first: the verification may open the place of an error, which must then keep the focus.
    await vscode.commands.executeCommand("workbench.view.testing.focus");
    if (await tests.verify(uri, [])) return;
    const name = vscode.workspace.asRelativePath(vscode.Uri.parse(uri));
    void vscode.window.showInformationMessage(vscode.l10n.t("{0} lists no properties that can be verified.", name));
}

async function debugSystem({ debugging }: Parts): Promise<void> {
    const program = await debugging.program(vscode.window.activeTextEditor?.document);
    if (program) await debugging.start(program, {});
}

async function showOfSystem(
    parts: Parts,
    kind: "tree" | "ros" | "system",
    document: vscode.TextDocument,
): Promise<void> {
    const about = await parts.documents.about(document);
    // A tree that belongs to no system is shown alone.
    const uri = kind === "tree" && about.systems.length === 0 ? document.uri : await parts.documents.system(document);
    if (uri) await parts.pictures.open(kind, uri);
}

async function checkWorkspace({ tasks }: Parts): Promise<void> {
    for (const folder of vscode.workspace.workspaceFolders ?? []) {
        const task = tasks.task({ type: Tasks.type, command: "check" }, folder);
        if (task) await vscode.tasks.executeTask(task);
    }
}

async function createProperty({ server, documents }: Parts): Promise<void> {
    const system = await documents.system(vscode.window.activeTextEditor?.document);
    const uri = system && server.client?.code2ProtocolConverter.asUri(system);
    if (uri !== undefined) await newProperty(server, uri);
}

async function migrateSystem({ server, documents }: Parts): Promise<void> {
    const system = await documents.system(vscode.window.activeTextEditor?.document);
    if (!system || !server.client) return;
    await vscode.workspace.saveAll();
    const migration = await server.ask(migrate, { textDocument: { uri: system.toString() } });
    if (!migration) return;
    if (migration.problem !== "") {
        void vscode.window.showErrorMessage(migration.problem);
        return;
    }
    const edit = await server.client.protocol2CodeConverter.asWorkspaceEdit(migration.edit ?? undefined);
    if (!edit || migration.files.length === 0) {
        void vscode.window.showInformationMessage(vscode.l10n.t("There is nothing to migrate."));
        return;
    }
    const [apply, show] = [vscode.l10n.t("Migrate"), vscode.l10n.t("Show Changes")];
    const question = vscode.l10n.t("Migrate {0} to the current dialect?", vscode.workspace.asRelativePath(system));
    const detail = [
        ...migration.files,
        "",
        vscode.l10n.t("Comments and layout are kept; Undo reverts the migration."),
    ].join("\n");
    const answer = await vscode.window.showInformationMessage(question, { modal: true, detail }, apply, show);
    if (answer === show) await showChanges(server, system);
    if (answer === apply && (await vscode.workspace.applyEdit(edit, { isRefactoring: true }))) {
        await vscode.workspace.saveAll();
    }
}

async function showChanges({ state }: LanguageServer, system: vscode.Uri): Promise<void> {
    if (state.kind !== "running") return;
    const { command, args } = state.server;
    const ended = await thisHost.run(command, [...args, "migrate", system.fsPath, "--diff"]);
    const content = ended.out === "" ? ended.err : ended.out;
    await vscode.window.showTextDocument(await vscode.workspace.openTextDocument({ language: "diff", content }));
}

async function selectInterpreter(): Promise<void> {
    const browse = { label: vscode.l10n.t("$(folder) Browse…"), path: "" };
    const automatic = { label: vscode.l10n.t("$(search) Find an interpreter automatically"), path: "" };
    const items = [browse, automatic];
    for await (const python of pythons(thisHost, [], untrustedFolders())) {
        items.push({ label: `Python ${python.version}`, path: python.executable, ...described(python) });
    }
    const title = vscode.l10n.t("The Python interpreter that starts the language server, or for which it is installed");
    const picked = await vscode.window.showQuickPick(items, { title, matchOnDescription: true });
    if (!picked) return;
    let value = picked.path;
    if (picked === browse) {
        const chosen = await vscode.window.showOpenDialog({ title, canSelectMany: false });
        if (!chosen?.[0]) return;
        value = chosen[0].fsPath;
    }
    const settings = vscode.workspace.getConfiguration("as2fm");
    await settings.update("interpreter", value === "" ? undefined : value, vscode.ConfigurationTarget.Global);
    await vscode.commands.executeCommand("as2fm.restart");
}

function described(python: { executable: string; server: string | undefined }): { description: string } {
    const server = python.server === undefined ? "" : ` · as2fm-lsp ${python.server}`;
    return { description: `${python.executable}${server}` };
}

async function showVersions({ context, server }: Parts): Promise<void> {
    const { version } = context.extension.packageJSON as { version: string };
    const { state } = server;
    const running =
        state.kind === "running"
            ? `as2fm-lsp ${state.server.version} (${tellOrigin(state.server.origin)}: ${state.server.command})`
            : vscode.l10n.t("as2fm-lsp is not running");
    const text = [`AS2FM ${version}`, running, `VS Code ${vscode.version}`].join("\n");
    const copy = vscode.l10n.t("Copy");
    const answer = await vscode.window.showInformationMessage(text.replaceAll("\n", " · "), copy);
    if (answer === copy) await vscode.env.clipboard.writeText(text);
}

/** Run the experiment of a file, or ask for one of a system. */
async function experiment(parts: Parts, of: string | vscode.Uri | undefined, parameter?: string): Promise<void> {
    const document = vscode.window.activeTextEditor?.document;
    const file = typeof of === "string" ? vscode.Uri.parse(of) : (of ?? document?.uri);
    if (file?.path.endsWith(EXPERIMENT_FILE)) {
        await parts.experiments.openFile(file);
        return;
    }
    const system = typeof of === "string" ? of : (await parts.documents.system(document))?.toString();
    if (system !== undefined) await parts.experiments.ask(system, parameter);
}

async function withEditor(run: (editor: vscode.TextEditor) => unknown): Promise<void> {
    const editor = vscode.window.activeTextEditor;
    if (editor) await run(editor);
}
