// SPDX-License-Identifier: Apache-2.0
/**
 * The time from opening a workspace to its first diagnostics, with an installed server.
 *
 * Most of it is spent in VS Code itself: an extension that only shows a diagnostic measures this part.
 */

import { sample } from "./support/stage";
import { fakeExtension, Workbench } from "./support/workbench";

const TIMES = 7;

const SHOWS_AT_ONCE = `
const vscode = require("vscode");
exports.activate = (context) => {
    const diagnostics = vscode.languages.createDiagnosticCollection("probe");
    const file = vscode.Uri.joinPath(vscode.workspace.workspaceFolders[0].uri, "main.xml");
    diagnostics.set(file, [new vscode.Diagnostic(new vscode.Range(0, 0, 0, 1), "here")]);
    context.subscriptions.push(diagnostics);
};
`;

const probe = fakeExtension("as2fm-lsp", "probe", SHOWS_AT_ONCE, ["workspaceContains:main.xml"]);
const bare = await Workbench.start({ bare: true, extensions: [probe] });
const workbench = await Workbench.start();
const first = await workbench.open(sample());
await first.acceptInstallation();
await first.firstProblem.waitFor({ timeout: 120_000 });
await workbench.forget();

const [least, whole]: [number[], number[]] = [[], []];
for (let i = 0; i < TIMES; i++) {
    least.push(await untilFirstProblem(bare));
    whole.push(await untilFirstProblem(workbench));
}
await bare.stop();
await workbench.stop();
console.log(
    `from opening a workspace to its first diagnostics: ${median(whole)} s; ` +
        `of an extension that has nothing to do: ${median(least)} s; median of ${TIMES}`,
);

/** The time in s. */
async function untilFirstProblem(workbench: Workbench): Promise<number> {
    const started = performance.now();
    const window = await workbench.open(sample());
    await window.firstProblem.waitFor();
    const ended = performance.now();
    await workbench.forget();
    return (ended - started) / 1000;
}

function median(values: readonly number[]): string {
    return (values.toSorted((a, b) => a - b)[TIMES >> 1] ?? NaN).toFixed(1);
}
