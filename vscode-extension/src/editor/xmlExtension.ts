// SPDX-License-Identifier: Apache-2.0
/**
 * Harmony with the XML extension, where that is installed.
 *
 * - It looks after files of the language `xml`: system files and behavior trees are among them. What is not well-formed
 *   in them it says, so we do not.
 * - Our schemas are offered to it as a catalog. They are used where a document asks for one of them by name; a document
 *   that does not is checked by us alone, so nothing is said twice.
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
