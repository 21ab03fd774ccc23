// SPDX-License-Identifier: Apache-2.0
/** The language server as a program, and the reasons why there is none. Plain data; the editor defines the texts. */

/** Where a server was found. */
export type Origin = "setting" | "python" | "path" | "private";

/** A program that communicates by LSP through its standard input and output. */
export interface Server {
    readonly origin: Origin;
    readonly command: string;
    /** The arguments before those of `as2fm-lsp`. */
    readonly args: readonly string[];
    readonly version: string;
}

/** Why there is no server. `detail` is the output of a program. */
export type Failure =
    | { readonly kind: "no-server" }
    | { readonly kind: "configured-server"; readonly path: string; readonly detail: string }
    | { readonly kind: "no-python" }
    | { readonly kind: "no-venv"; readonly python: string; readonly detail: string }
    | { readonly kind: "no-packages"; readonly python: string; readonly detail: string }
    | { readonly kind: "start"; readonly server: Server; readonly detail: string }
    | { readonly kind: "crashes"; readonly server: Server; readonly count: number; readonly detail: string }
    | { readonly kind: "internal"; readonly detail: string };

export type FailureKind = Failure["kind"];

export function isFailure(value: Server | Failure | undefined): value is Failure {
    return value !== undefined && "kind" in value;
}

export function isServer(value: unknown): value is Server {
    if (typeof value !== "object" || value === null) return false;
    const { origin, command, args, version } = value as Partial<Record<keyof Server, unknown>>;
    const texts = [origin, command, version, ...(Array.isArray(args) ? (args as unknown[]) : [undefined])];
    return texts.every((text) => typeof text === "string");
}
