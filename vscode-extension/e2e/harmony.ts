// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as path from "node:path";
import { MEND, sample, type Stage } from "./support/stage";
import { temporaryFolder, write } from "./support/workbench";

/** Stands in for the XML extension: the part of its interface that is used, and what it says of ill-formed files. */
const XML_EXTENSION = `
const vscode = require("vscode");
exports.activate = () => {
    const found = vscode.languages.createDiagnosticCollection("xml");
    const look = (document) => {
        if (document.languageId !== "xml") return;
        const bad = document.getText().includes("<ill");
        const range = new vscode.Range(0, 0, 0, 1);
        found.set(document.uri, bad ? [new vscode.Diagnostic(range, "XML extension: not well-formed")] : []);
    };
    vscode.workspace.textDocuments.forEach(look);
    vscode.workspace.onDidOpenTextDocument(look);
    vscode.workspace.onDidChangeTextDocument((event) => look(event.document));
    return { addXMLCatalogs: (catalogs) => vscode.window.showInformationMessage("catalogs: " + catalogs.join()) };
};
`;

export function harmony(stage: Stage): void {
    stage.use({ extensions: [xmlExtension()] });
    const illFormed = () => sample({ ...MEND, "tree.xml": (text) => text.replace("<Charge />", "<ill") });

    stage.test("nothing is said twice, and the schemas are offered", illFormed, async (window) => {
        await window.openFile("tree.xml");
        await window.running();
        await window.notification(path.join("dist", "schemas", "catalog.xml")).waitFor();
        await window.run("View: Focus Problems");
        const rows = window.page.locator(
            ".markers-panel .monaco-list-row .marker-message-line, .markers-panel .monaco-list-row",
        );
        await rows.filter({ hasText: "XML extension: not well-formed" }).first().waitFor();
        // What the model lacks is still said, by us alone.
        await window.screenshot("harmony");
        assert.equal(await rows.filter({ hasText: "xml-syntax" }).count(), 0);
    });
}

function xmlExtension(): string {
    const folder = path.join(temporaryFolder("xml"), "redhat.vscode-xml-0.0.1");
    const manifest = {
        ...{ name: "vscode-xml", publisher: "redhat", version: "0.0.1", engines: { vscode: "^1.90.0" } },
        ...{ main: "./main.js", activationEvents: ["onLanguage:xml"] },
    };
    write(path.join(folder, "package.json"), JSON.stringify(manifest));
    write(path.join(folder, "main.js"), XML_EXTENSION);
    return folder;
}
