// SPDX-License-Identifier: Apache-2.0
/** The entry point of the extension: creates its parts and connects them. */

import * as vscode from "vscode";
import { registerCommands } from "./editor/commands";
import { ChoicesView } from "./editor/choices";
import { Counterexamples } from "./editor/counterexamples";
import { DebugSessions } from "./editor/debugSessions";
import { Debugging } from "./editor/debugging";
import { Documents } from "./editor/documents";
import { Experiments } from "./editor/experiments";
import { JaniView } from "./editor/janiView";
import { PicturePanels } from "./editor/picturePanels";
import { PlainScxmlPreview } from "./editor/plainScxml";
import { onInterpreterChange } from "./editor/pythonExtensions";
import { watchEditors } from "./editor/recentEditor";
import { ResultsView } from "./editor/results";
import { LanguageServer } from "./editor/server";
import { Stage } from "./editor/stage";
import { StopReasons } from "./editor/stopReasons";
import { StatusItem } from "./editor/statusItem";
import { done, watchErrors } from "./editor/steps";
import { Tasks } from "./editor/tasks";
import { PropertyTests } from "./editor/tests";
import { PictureActions } from "./editor/pictureActions";
import { PictureActivity } from "./editor/pictureActivity";
import { TimelineView } from "./editor/timeline";
import { Activation } from "./editor/activation";
import { offerSchemas } from "./editor/xmlExtension";

let server: LanguageServer | undefined;

export function activate(context: vscode.ExtensionContext): void {
    const log = vscode.window.createOutputChannel("AS2FM", { log: true });
    server = new LanguageServer(context, log, {
        onTranslated: ({ uri }) => {
            done("translated");
            return jani.open(vscode.Uri.parse(uri), vscode.ViewColumn.Beside);
        },
        onVerify: (system, names) => tests.verify(system, names),
    });
    const status = new StatusItem(log);
    const documents = new Documents(server);
    const plain = new PlainScxmlPreview(server);
    const jani = new JaniView(server);
    const pictures = new PicturePanels(context, server, log);
    const tasks = new Tasks(server);
    const debugging = new Debugging(server, documents);
    const tests = new PropertyTests(server, debugging, log);
    const sessions = new DebugSessions();
    const activation = new Activation();
    const experiments = new Experiments(context, server, debugging);
    const counterexamples = new Counterexamples(server, pictures, debugging);
    context.subscriptions.push(
        log,
        server,
        activation,
        status,
        documents,
        plain,
        jani,
        pictures,
        tests,
        counterexamples,
        experiments,
        new ResultsView(tests),
        sessions,
        new ChoicesView(sessions, log),
        new StopReasons(sessions, log),
        new TimelineView(context, sessions),
        new PictureActions(server, pictures),
        new PictureActivity(sessions, pictures),
        new Stage(context, sessions, pictures, server, log),
        ...debugging.register(),
        watchErrors(),
        watchEditors(),
    );
    server.onState((state) => {
        status.show(state);
    });
    pictures.onVerified(() => void tests.refresh());
    tests.onSystems(() => {
        pictures.refreshCoverage();
    });
    const shown = { plain, jani, pictures, tests, counterexamples, debugging, experiments };
    registerCommands({ context, log, server, activation, status, documents, tasks, ...shown });
    context.subscriptions.push(vscode.tasks.registerTaskProvider(Tasks.type, tasks));
    watchSettings(context, server, log);
    void start(context, server, activation, log);
}

async function start(
    context: vscode.ExtensionContext,
    server: LanguageServer,
    activation: Activation,
    log: vscode.LogOutputChannel,
): Promise<void> {
    await activation.needed();
    await Promise.all([server.open(), offerSchemas(context, log)]);
}

export async function deactivate(): Promise<void> {
    await server?.stop();
}

/** Search for the server again when a setting or an interpreter changes. */
function watchSettings(context: vscode.ExtensionContext, server: LanguageServer, log: vscode.LogOutputChannel): void {
    const again = () => void server.start();
    context.subscriptions.push(
        vscode.workspace.onDidGrantWorkspaceTrust(again),
        vscode.workspace.onDidChangeConfiguration((event) => {
            if (event.affectsConfiguration("as2fm.server.path") || event.affectsConfiguration("as2fm.interpreter")) {
                again();
            } else if (event.affectsConfiguration("as2fm")) {
                server.settingsChanged();
            }
        }),
    );
    // A running server that was not found in a Python environment does not depend on the interpreter.
    const onChange = () => {
        if (server.state.kind === "failed" || usesPython(server)) void server.look();
    };
    onInterpreterChange(onChange).then(
        (subscriptions) => {
            context.subscriptions.push(...subscriptions);
        },
        (error: unknown) => {
            log.warn(String(error));
        },
    );
}

function usesPython({ state }: LanguageServer): boolean {
    return state.kind === "running" && state.server.origin === "python";
}
