// SPDX-License-Identifier: Apache-2.0
/**
 * The life of the server: searching, installing, starting, running, failed.
 *
 * - There is one state at a time and each change of it is told; nothing else decides what the user sees.
 * - A server that ends by itself is started again, and the user is told; one that keeps ending is left alone.
 * - What has been overtaken by a newer wish changes nothing any more.
 */

import { isDeepStrictEqual } from "node:util";
import type { Step } from "./environment";
import { isFailure, type Failure, type Server } from "./server";

export type State =
    | { readonly kind: "stopped" }
    | { readonly kind: "searching" }
    | { readonly kind: "installing"; readonly step: Step }
    | { readonly kind: "starting"; readonly server: Server }
    | { readonly kind: "running"; readonly server: Server }
    | { readonly kind: "failed"; readonly failure: Failure };

/** How a server's process ended. */
export interface Exit {
    readonly status: number | null;
    readonly signal: string | null;
    /** The last that it said on its standard error. */
    readonly detail: string;
}

/** A server that has answered. */
export interface Session {
    /** Settles when the process has ended, whoever ended it. */
    readonly ended: Promise<Exit>;
    stop(): Promise<void>;
}

export interface Ports {
    /** `hurry`: nothing runs until a server is found, so whoever does not say soon where one is, is passed over. */
    find(hurry: boolean): Promise<Server | Failure>;
    install(onStep: (step: Step) => void): Promise<Server | Failure>;
    /** Start a server and wait until it has answered. */
    launch(server: Server): Promise<Session>;
    /** In milliseconds. */
    now(): number;
    changed(state: State): void;
    /** A server has ended by itself and runs again. */
    restarted(exit: Exit): void;
}

/** A server may end by itself this often within `CRASH_WINDOW` milliseconds and is started again. */
export const MAX_CRASHES = 3;
export const CRASH_WINDOW = 180_000;

export class Supervisor {
    private current: State = { kind: "stopped" };
    private session: Session | undefined;
    private wish = 0;
    private crashes: number[] = [];

    constructor(private readonly ports: Ports) {}

    get state(): State {
        return this.current;
    }

    /** Look for a server and start it; one that runs is ended first. */
    async start(): Promise<void> {
        const wish = await this.begin();
        this.set(wish, { kind: "searching" });
        await this.use(wish, () => this.ports.find(true));
    }

    /** As `start`, but the server that will probably be found is started first: a search may take longer than a start. */
    async expect(server: Server): Promise<void> {
        const wish = await this.begin();
        await this.launch(wish, server);
        if (wish === this.wish) await this.look();
    }

    /** Look for a server again: the one that runs goes on, unless it is another that is found. */
    async look(): Promise<void> {
        if (this.current.kind === "running") {
            const [wish, { server }] = [this.wish, this.current];
            // A search that fails is made again, and what is wrong then told, by `start`.
            const found = await this.ports.find(false).catch(() => undefined);
            if (wish !== this.wish || isDeepStrictEqual(found, server)) return;
        }
        await this.start();
    }

    /** Make the private environment and start the server in it. */
    async install(): Promise<void> {
        const wish = await this.begin();
        this.set(wish, { kind: "installing", step: "python" });
        await this.use(wish, () =>
            this.ports.install((step) => {
                this.set(wish, { kind: "installing", step });
            }),
        );
    }

    async stop(): Promise<void> {
        const wish = await this.begin();
        this.set(wish, { kind: "stopped" });
    }

    private async begin(): Promise<number> {
        const wish = ++this.wish;
        this.crashes = [];
        const session = this.session;
        this.session = undefined;
        await session?.stop();
        return wish;
    }

    private async use(wish: number, get: () => Promise<Server | Failure>): Promise<void> {
        try {
            const found = await get();
            if (wish !== this.wish) return;
            if (isFailure(found)) this.set(wish, { kind: "failed", failure: found });
            else {
                const error = await this.launch(wish, found);
                if (error !== undefined) {
                    this.set(wish, { kind: "failed", failure: { kind: "start", server: found, detail: error } });
                }
            }
        } catch (error) {
            this.set(wish, { kind: "failed", failure: { kind: "internal", detail: said(error) } });
        }
    }

    /** Start a server; why it has not started, or undefined if it runs or is not wanted any more. */
    private async launch(wish: number, server: Server): Promise<string | undefined> {
        this.set(wish, { kind: "starting", server });
        let session: Session;
        try {
            session = await this.ports.launch(server);
        } catch (error) {
            return said(error);
        }
        if (wish !== this.wish) {
            await session.stop();
            return undefined;
        }
        this.session = session;
        this.set(wish, { kind: "running", server });
        void session.ended.then((exit) => this.ended(wish, server, session, exit));
        return undefined;
    }

    private async ended(wish: number, server: Server, session: Session, exit: Exit): Promise<void> {
        if (wish !== this.wish || session !== this.session) return;
        this.session = undefined;
        for (let last = exit; this.mayGoOn(wish, server, last);) {
            const error = await this.launch(wish, server);
            if (wish !== this.wish) return;
            if (error === undefined) {
                this.ports.restarted(exit);
                return;
            }
            // One that ends before it has answered has ended once more.
            last = { status: null, signal: null, detail: error };
        }
    }

    /** Count that the server has ended by itself; whether it is to be started again. */
    private mayGoOn(wish: number, server: Server, { detail }: Exit): boolean {
        const now = this.ports.now();
        this.crashes = [...this.crashes.filter((time) => now - time < CRASH_WINDOW), now];
        const count = this.crashes.length;
        if (count <= MAX_CRASHES) return true;
        this.set(wish, { kind: "failed", failure: { kind: "crashes", server, count, detail } });
        return false;
    }

    private set(wish: number, state: State): void {
        if (wish !== this.wish) return;
        this.current = state;
        this.ports.changed(state);
    }
}

function said(error: unknown): string {
    return error instanceof Error ? error.message : String(error);
}
