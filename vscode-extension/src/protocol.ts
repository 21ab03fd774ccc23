// SPDX-License-Identifier: Apache-2.0
/** What client and server say to each other beyond the language server protocol. */

import type { Range, TextDocumentIdentifier, WorkspaceEdit } from "vscode-languageserver-protocol";
import { RequestType } from "vscode-languageserver-protocol";
import type { Picture, PictureKind } from "./pictures/contract";

export type FileKind = "machine" | "system" | "tree" | "structs" | "properties" | "interface" | "";

/** What a document is. `systems` are the URIs of the systems that it belongs to, itself if it is one. */
export interface About {
    readonly kind: FileKind;
    readonly systems: readonly string[];
    /** Whether there is a behavior tree: in the file itself or in its system. */
    readonly hasTree: boolean;
}

export interface DocumentParams {
    readonly textDocument: TextDocumentIdentifier;
}

export interface PictureParams extends DocumentParams {
    readonly kind: PictureKind;
}

/** A line of the plain form and the place in the models that it exists for. */
export interface PlainLine {
    readonly line: number;
    readonly uri: string;
    readonly range: Range;
}

/** A machine as plain SCXML. `problem` says why there is none. */
export interface PlainScxml {
    readonly text: string;
    readonly lines: readonly PlainLine[];
    readonly problem: string;
}

export interface Migration {
    readonly edit: WorkspaceEdit | null;
    /** What changes, one line for each file. */
    readonly files: readonly string[];
    readonly problem: string;
}

export const about = new RequestType<DocumentParams, About, void>("as2fm/about");
export const picture = new RequestType<PictureParams, Picture | null, void>("as2fm/picture");
export const plainScxml = new RequestType<DocumentParams, PlainScxml, void>("as2fm/plainScxml");
export const migrate = new RequestType<DocumentParams, Migration, void>("as2fm/migrate");

/** The server's own command; the client opens what it answers. */
export const TRANSLATE = "as2fm.translateToJani";

export interface Translated {
    readonly uri: string;
    readonly summary: string;
}
