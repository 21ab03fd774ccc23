// SPDX-License-Identifier: Apache-2.0
/**
 * The states of the server: searching, installing, starting, running, failed.
 *
 * - There is one state at a time, and each change is reported; the user sees nothing else.
 * - A server that crashes is restarted with a message; one that crashes repeatedly is not.
 * - A new request makes older ones irrelevant: their results are ignored.
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

/** How the process of a server ended. */
export interface Exit {
    readonly status: number | null;
    readonly signal: string | null;
    /** The end of its standard error. */
    readonly detail: string;
}

/** A running server, after the handshake. */
export interface Session {
    /** Settles when the process has ended, for whatever reason. */
    readonly ended: Promise<Exit>;
    stop(): Promise<void>;
}

export interface Ports {
    /** Searches for a server. `hurry`: no server runs yet, so sources that do not answer soon are skipped. */
    find(hurry: boolean): Promise<Server | Failure>;
    install(onStep: (step: Step) => void): Promise<Server | Failure>;
    /** Start a server and wait for the handshake. */
    launch(server: Server): Promise<Session>;
    /** Waits for a time in ms. */
    now(): number;
    changed(state: State): void;
    /** Called when a server has crashed and runs again. */
    restarted(exit: Exit): void;
}

/** The maximum number of crashes within `CRASH_WINDOW` ms after which a server is restarted. */
export const MAX_CRASHES = 3;
export const CRASH_WINDOW = 180_000;

export class Supervisor {
    private current: State = { kind: "stopped" };
    private session: Session | undefined;
    private request = 0;
    private crashes: number[] = [];

    constructor(private readonly ports: Ports) {}

    get state(): State {
        return this.current;
    }

    /** Search for a server and start it. A running one is stopped first. */
    async start(): Promise<void> {
        const request = await this.begin();
        this.set(request, { kind: "searching" });
        await this.use(request, () => this.ports.find(true));
    }

    /** Like `start`, but first start the server that the search will probably return, because a search may take longer. */
    async expect(server: Server): Promise<void> {
        const request = await this.begin();
        await this.launch(request, server);
        if (request === this.request) await this.look();
    }

    /** Search for a server again. The running one continues, unless the search returns another one. */
    async look(): Promise<void> {
        if (this.current.kind === "running") {
            const [request, { server }] = [this.request, this.current];
            // If the search fails, `start` repeats it and reports the reason.
            const current = await this.ports.find(false).catch(() => undefined);
            if (request !== this.request || isDeepStrictEqual(current, server)) return;
        }
        await this.start();
    }

    /** Create the private environment and start the server in it. */
    async install(): Promise<void> {
        const request = await this.begin();
        this.set(request, { kind: "installing", step: "python" });
        await this.use(request, () =>
            this.ports.install((step) => {
                this.set(request, { kind: "installing", step });
            }),
        );
    }

    async stop(): Promise<void> {
        const request = await this.begin();
        this.set(request, { kind: "stopped" });
    }

    private async begin(): Promise<number> {
        const request = ++this.request;
        this.crashes = [];
        const session = this.session;
        this.session = undefined;
        await session?.stop();
        return request;
    }

    private async use(request: number, get: () => Promise<Server | Failure>): Promise<void> {
        try {
            const server = await get();
            if (request !== this.request) return;
            if (isFailure(server)) this.set(request, { kind: "failed", failure: server });
            else {
                const error = await this.launch(request, server);
                if (error !== undefined) {
                    this.set(request, { kind: "failed", failure: { kind: "start", server, detail: error } });
                }
            }
        } catch (error) {
            this.set(request, { kind: "failed", failure: { kind: "internal", detail: said(error) } });
        }
    }

    /** Start a server. Returns why it has not started; undefined if it runs or is no longer needed. */
    private async launch(request: number, server: Server): Promise<string | undefined> {
        this.set(request, { kind: "starting", server });
        let session: Session;
        try {
            session = await this.ports.launch(server);
        } catch (error) {
            return said(error);
        }
        if (request !== this.request) {
            await session.stop();
            return undefined;
        }
        this.session = session;
        this.set(request, { kind: "running", server });
        void session.ended.then((exit) => this.ended(request, server, session, exit));
        return undefined;
    }

    private async ended(request: number, server: Server, session: Session, exit: Exit): Promise<void> {
        if (request !== this.request || session !== this.session) return;
        this.session = undefined;
        for (let last = exit; this.mayGoOn(request, server, last);) {
            const error = await this.launch(request, server);
            if (request !== this.request) return;
            if (error === undefined) {
                this.ports.restarted(exit);
                return;
            }
            // A server that ends before the handshake has also crashed.
            last = { status: null, signal: null, detail: error };
        }
    }

    /** Count a crash of the server. Returns whether to restart it. */
    private mayGoOn(request: number, server: Server, { detail }: Exit): boolean {
        const now = this.ports.now();
        this.crashes = [...this.crashes.filter((time) => now - time < CRASH_WINDOW), now];
        const count = this.crashes.length;
        if (count <= MAX_CRASHES) return true;
        this.set(request, { kind: "failed", failure: { kind: "crashes", server, count, detail } });
        return false;
    }

    private set(request: number, state: State): void {
        if (request !== this.request) return;
        this.current = state;
        this.ports.changed(state);
    }
}

function said(error: unknown): string {
    return error instanceof Error ? error.message : String(error);
}
