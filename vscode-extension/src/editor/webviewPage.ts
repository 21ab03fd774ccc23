// SPDX-License-Identifier: Apache-2.0
// Panels with a page, and the page of a webview: one script, with styles from files only.

import { randomBytes } from "node:crypto";

import * as vscode from "vscode";

/** A panel that keeps its page while it is hidden. Its page can load files of `dist` only. */
export function webviewPanel(
    context: vscode.ExtensionContext,
    dist: vscode.Uri,
    viewType: string,
    title: string,
    column: Parameters<typeof vscode.window.createWebviewPanel>[2],
): vscode.WebviewPanel {
    const panel = vscode.window.createWebviewPanel(viewType, title, column, {
        enableScripts: true,
        enableForms: false,
        enableCommandUris: false,
        retainContextWhenHidden: true,
        localResourceRoots: [dist],
    });
    panel.iconPath = vscode.Uri.joinPath(context.extensionUri, "icons", "as2fm.png");
    return panel;
}

/** `dist` is the folder of the script and of the styles. */
export function webviewPage(
    webview: vscode.Webview,
    dist: vscode.Uri,
    script: string,
    styles: readonly string[],
): string {
    const nonce = randomBytes(16).toString("base64");
    const uri = (name: string) => webview.asWebviewUri(vscode.Uri.joinPath(dist, name)).toString();
    const policy = [
        "default-src 'none'",
        `script-src 'nonce-${nonce}'`,
        `style-src ${webview.cspSource}`,
        "img-src blob: data:",
        "base-uri 'none'",
        "form-action 'none'",
    ].join("; ");
    const links = styles.map((name) => `<link rel="stylesheet" href="${uri(name)}">`).join("\n");
    return `<!DOCTYPE html>
<html lang="${vscode.env.language}">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="${policy}">
${links}
</head>
<body>
<script nonce="${nonce}" src="${uri(script)}"></script>
</body>
</html>`;
}
