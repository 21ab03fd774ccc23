// SPDX-License-Identifier: Apache-2.0
/** The breakpoints of VS Code as those of pictures. */

import * as vscode from "vscode";
import type { Breakpoint } from "../pictures/contract";
import { keyOf } from "../pictures/breakpoints";

type Encode = (uri: vscode.Uri) => string;

/** The breakpoints that are set; `encode` returns a URI in the form of the server. */
export function breakpoints(encode: Encode): Breakpoint[] {
    return vscode.debug.breakpoints.flatMap((set) => read(set, encode) ?? []);
}

function read(set: vscode.Breakpoint, encode: Encode): Breakpoint | undefined {
    if (!set.enabled) return undefined;
    if (set instanceof vscode.FunctionBreakpoint) return { label: set.functionName, event: set.functionName };
    if (!(set instanceof vscode.SourceBreakpoint)) return undefined;
    const { uri, range } = set.location;
    return { label: "", uri: encode(uri), line: range.start.line };
}

/** Set a breakpoint, or remove it if it is set. */
export function toggle(breakpoint: Breakpoint): void {
    const plain = (uri: vscode.Uri) => uri.toString();
    const key =
        "uri" in breakpoint
            ? keyOf({ ...breakpoint, uri: plain(vscode.Uri.parse(breakpoint.uri)) })
            : keyOf(breakpoint);
    const same = vscode.debug.breakpoints.filter((set) => {
        const other = read(set, plain);
        return other !== undefined && keyOf(other) === key;
    });
    if (same.length > 0) {
        vscode.debug.removeBreakpoints(same);
        return;
    }
    const added =
        "event" in breakpoint
            ? new vscode.FunctionBreakpoint(breakpoint.event)
            : new vscode.SourceBreakpoint(
                  new vscode.Location(vscode.Uri.parse(breakpoint.uri), new vscode.Position(breakpoint.line, 0)),
              );
    vscode.debug.addBreakpoints([added]);
}
