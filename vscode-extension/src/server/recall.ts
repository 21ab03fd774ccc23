// SPDX-License-Identifier: Apache-2.0
/**
 * The server that ran last in a workspace: with the same wishes it is probably found again, and need not be waited for.
 * To ask an extension for Python and an interpreter takes longer than to start the server.
 */

import { isDeepStrictEqual } from "node:util";
import { isServer, type Server } from "./server";

/** What is kept from one window to the next, as `vscode.Memento` does. */
export interface Store {
    get(key: string): unknown;
    update(key: string, value: unknown): PromiseLike<void>;
}

const KEY = "server";

export class Recall {
    constructor(private readonly store: Store) {}

    /** The server that ran last, if it was wished for in the same way. */
    server(wishes: readonly unknown[]): Server | undefined {
        const kept = this.store.get(KEY);
        if (typeof kept !== "object" || kept === null || !("wishes" in kept) || !("server" in kept)) return undefined;
        return isDeepStrictEqual(kept.wishes, wishes) && isServer(kept.server) ? kept.server : undefined;
    }

    async keep(wishes: readonly unknown[], server: Server): Promise<void> {
        if (!isDeepStrictEqual(this.server(wishes), server)) await this.store.update(KEY, { wishes, server });
    }
}
