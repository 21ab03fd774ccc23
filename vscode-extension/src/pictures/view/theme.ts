// SPDX-License-Identifier: Apache-2.0

import type { Theme } from "../contract";

/** The kind of the theme of the editor, in a webview. */
export function theme(): Theme {
    const { classList } = document.body;
    if (classList.contains("vscode-high-contrast-light")) return "high-contrast-light";
    if (classList.contains("vscode-high-contrast")) return "high-contrast";
    return classList.contains("vscode-dark") ? "dark" : "light";
}
