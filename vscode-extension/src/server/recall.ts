// SPDX-License-Identifier: Apache-2.0
/**
 * The server that ran last in a workspace. With the same settings, the search will probably return it again, so it is
 * started before the search ends: querying extensions for Python and an interpreter takes longer than starting the
 * server.
 */

import { isDeepStrictEqual } from "node:util";
import { isServer, type Server } from "./server";

/** Storage that persists between windows, such as `vscode.Memento`. */
export interface Store {
    get(key: string): unknown;
    update(key: string, value: unknown): PromiseLike<void>;
}

const KEY = "server";

export class Recall {
    constructor(private readonly store: Store) {}

    /** The server that ran last, if it was found with the same settings. */
    server(settings: readonly unknown[]): Server | undefined {
        const kept = this.store.get(KEY);
        if (typeof kept !== "object" || kept === null || !("settings" in kept) || !("server" in kept)) return undefined;
        return isDeepStrictEqual(kept.settings, settings) && isServer(kept.server) ? kept.server : undefined;
    }

    async keep(settings: readonly unknown[], server: Server): Promise<void> {
        if (!isDeepStrictEqual(this.server(settings), server)) await this.store.update(KEY, { settings, server });
    }
}
