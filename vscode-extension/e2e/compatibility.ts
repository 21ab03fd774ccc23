// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { VERSION } from "./support/paths";
import { MEND, sample, SharedFolder, type Stage } from "./support/stage";
import { fakeExtension, temporaryFolder, write } from "./support/workbench";

/** Replaces the XML extension: the used part of its interface, and its diagnostics for ill-formed files. */
const XML_EXTENSION = `
const vscode = require("vscode");
exports.activate = () => {
    const diagnostics = vscode.languages.createDiagnosticCollection("xml");
    const look = (document) => {
        if (document.languageId !== "xml") return;
        const bad = document.getText().includes("<ill");
        const range = new vscode.Range(0, 0, 0, 1);
        diagnostics.set(document.uri, bad ? [new vscode.Diagnostic(range, "XML extension: not well-formed")] : []);
    };
    vscode.workspace.textDocuments.forEach(look);
    vscode.workspace.onDidOpenTextDocument(look);
    vscode.workspace.onDidChangeTextDocument((event) => look(event.document));
    return { addXMLCatalogs: (catalogs) => vscode.window.showInformationMessage("catalogs: " + catalogs.join()) };
};
`;

/**
 * Replaces the Python extension: the active interpreter is the one that the folder's `.python` names. It is reported
 * when there is no `.python-starts`.
 */
const PYTHON_EXTENSION = `
const vscode = require("vscode");
const fs = require("fs");
const active = (folder) => {
    try { return { path: fs.readFileSync(vscode.Uri.joinPath(folder, ".python").fsPath, "utf8") }; }
    catch { return { path: "" }; }
};
const starts = () => fs.existsSync(vscode.Uri.joinPath(vscode.workspace.workspaceFolders[0].uri, ".python-starts").fsPath);
exports.activate = async () => {
    while (starts()) await new Promise((resolve) => setTimeout(resolve, 50));
    return {
        environments: {
            getActiveEnvironmentPath: active,
            resolveEnvironment: async ({ path }) => path && { executable: { uri: vscode.Uri.file(path) } },
            onDidChangeActiveEnvironmentPath: new vscode.EventEmitter().event,
        },
    };
};
`;

export function compatibility(stage: Stage): void {
    const xml = fakeExtension("redhat", "vscode-xml", XML_EXTENSION, ["onLanguage:xml"]);
    const python = fakeExtension("ms-python", "python", PYTHON_EXTENSION, []);
    stage.use({ extensions: [xml, python] });
    const other = () => {
        const folder = path.join(temporaryFolder("other"), "other");
        write(path.join(folder, "main.xml"), "<project />");
        return folder;
    };
    const illFormed = () => sample({ ...MEND, "tree.xml": (text) => text.replace("<Charge />", "<ill") });

    stage.test("the server is not started for other projects with a main.xml", other, async (window) => {
        await window.openFile("main.xml");
        await window.run("View: Focus Problems");
        await window.page.locator(".markers-panel", { hasText: "No problems" }).waitFor();
        assert.equal(await window.statusItem("AS2FM").count(), 0);
        await window.screenshot("left-alone");
        // The server is started when a supported file is opened.
        write(path.join(window.folder, "battery.ascxml"), "<ascxml />");
        await window.page.locator(".explorer-folders-view .monaco-list-row", { hasText: "battery.ascxml" }).dblclick();
        await window.running();
    });

    const tree = () => {
        const folder = path.join(temporaryFolder("tree"), "tree");
        write(path.join(folder, "package.xml"), '<package format="3"><name>trees</name></package>');
        const nodes = "<Sequence><Inverter /></Sequence>";
        const text = `<root BTCPP_format="4"><BehaviorTree ID="Main">${nodes}</BehaviorTree></root>`;
        write(path.join(folder, "navigate.xml"), text);
        return folder;
    };

    stage.test("a behavior tree without a system is checked once it is opened", tree, async (window) => {
        await window.openFile("package.xml");
        await window.run("View: Focus Problems");
        await window.page.locator(".markers-panel", { hasText: "No problems" }).waitFor();
        assert.equal(await window.statusItem("AS2FM").count(), 0);
        await window.openFile("navigate.xml");
        await window.running();
        const rows = window.page.locator(".markers-panel .monaco-list-row");
        await rows.filter({ hasText: "`Inverter` needs one child and has none" }).first().waitFor();
    });

    stage.test(
        "no diagnostic is duplicated, and the schemas are offered to the XML extension",
        illFormed,
        async (window) => {
            await window.openFile("tree.xml");
            await window.running();
            await window.notified(path.join("dist", "schemas", "catalog.xml"));
            await window.run("View: Focus Problems");
            const rows = window.page.locator(".markers-panel .monaco-list-row");
            await rows.filter({ hasText: "XML extension: not well-formed" }).first().waitFor();
            // Errors in the model are still reported, only by this extension.
            await rows.filter({ hasText: "there is no node `ill`" }).waitFor();
            await window.screenshot("harmony");
            await window.becomes(() => rows.filter({ hasText: "xml-syntax" }).count(), 0);
        },
    );

    const withPython = new SharedFolder(() => {
        const folder = sample();
        write(path.join(folder, ".python"), privatePython(stage.workbench.home));
        return folder;
    });
    stage.test("the server of the active Python environment is used", withPython, async (window) => {
        await window.openFile("battery.ascxml");
        await window.squiggles.first().waitFor();
        await window.run("AS2FM: Show Versions");
        await window.notified("from the Python environment");
    });

    stage.test("the last server is started before the search ends", withPython, async (window) => {
        await window.openFile("battery.ascxml");
        await window.running();
        const starts = path.join(window.folder, ".python-starts");
        write(starts, "");
        await Promise.all([window.page.waitForEvent("load"), window.run("Developer: Reload Window")]);
        await window.squiggles.first().waitFor();
        await window.run("AS2FM: Show Versions");
        await window.notified("from the Python environment");
        // The Python extension now reports its interpreter, which is another one.
        write(path.join(window.folder, ".python"), "");
        fs.rmSync(starts);
        await window
            .statusItem(`AS2FM: ${VERSION}`)
            .and(window.page.locator('[aria-label*="own environment"]'))
            .waitFor();
        await window.squiggles.first().waitFor();
    });
}

function privatePython(home: string): string {
    const environments = path.join(home, "data/data/User/globalStorage/as2fm-lsp.as2fm/environments");
    const [name] = fs.readdirSync(environments);
    assert.ok(name !== undefined);
    return path.join(environments, name, "bin/python");
}
