// SPDX-License-Identifier: Apache-2.0
/**
 * Cooperation with the XML extension, if it is installed.
 *
 * - It checks files of the language `xml`, such as system files and behavior trees. It reports errors of
 *   well-formedness in them, so the client hides those of the server.
 * - The client offers its schemas to it as a catalog. It uses them in documents that refer to one of them by name; only
 *   the server checks other documents, so that nothing is reported twice.
 */

import * as vscode from "vscode";

const XML = "redhat.vscode-xml";

interface XmlApi {
    addXMLCatalogs?(catalogs: string[]): void;
    removeXMLCatalogs?(catalogs: string[]): void;
}

export function ownsWellFormedness(): boolean {
    return vscode.extensions.getExtension(XML)?.isActive ?? false;
}

export async function offerSchemas(context: vscode.ExtensionContext, log: vscode.LogOutputChannel): Promise<void> {
    try {
        const xml = vscode.extensions.getExtension<XmlApi>(XML);
        const api = xml && (await xml.activate());
        if (!api?.addXMLCatalogs) return;
        const catalog = [vscode.Uri.joinPath(context.extensionUri, "dist", "schemas", "catalog.xml").fsPath];
        api.addXMLCatalogs(catalog);
        log.info("The schemas of HL-SCXML are offered to the XML extension.");
        context.subscriptions.push({ dispose: () => api.removeXMLCatalogs?.(catalog) });
    } catch (error) {
        log.warn(`The schemas cannot be offered to the XML extension: ${String(error)}`);
    }
}
