// SPDX-License-Identifier: Apache-2.0
// The page of a webview: one script, with styles from files only.

import { randomBytes } from "node:crypto";

import * as vscode from "vscode";

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
