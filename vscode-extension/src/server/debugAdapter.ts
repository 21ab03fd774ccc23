// SPDX-License-Identifier: Apache-2.0
/** A debug adapter that is started and asked without the debugger of the editor. */

import { spawn, type ChildProcess } from "node:child_process";
import { StreamMessageReader, StreamMessageWriter } from "vscode-languageserver-protocol/node.js";
import { safeFolder, safeVariables } from "./surroundings";

/** A message of the Debug Adapter Protocol. */
interface Message {
    readonly type: "request" | "response" | "event";
    readonly event?: string;
    readonly request_seq?: number;
    readonly success?: boolean;
    readonly message?: string;
    readonly body?: unknown;
}

interface Waiting {
    readonly resolve: (body: unknown) => void;
    readonly reject: (error: Error) => void;
}

export class DebugAdapter {
    private readonly process: ChildProcess;
    private readonly writer: StreamMessageWriter;
    private readonly waiting = new Map<number, Waiting>();
    private readonly listeners = new Map<string, () => void>();
    private readonly expected = new Map<string, Waiting>();
    private count = 0;

    /** `onEnd` is called once, when the process has ended or could not be started. */
    constructor(
        command: string,
        args: readonly string[],
        private readonly onEnd: () => void,
    ) {
        const child = spawn(command, args, {
            stdio: ["pipe", "pipe", "ignore"],
            windowsHide: true,
            cwd: safeFolder(),
            env: { ...process.env, ...safeVariables(process.env) },
        });
        this.process = child;
        this.writer = new StreamMessageWriter(child.stdin);
        child.stdin.on("error", () => undefined); // the process has ended, which is handled below
        new StreamMessageReader(child.stdout).listen((message) => {
            this.receive(message as unknown as Message);
        });
        child.once("error", () => {
            this.ended();
        });
        child.once("exit", () => {
            this.ended();
        });
    }

    /** Call a function whenever an event arrives. */
    on(event: string, listener: () => void): void {
        this.listeners.set(event, listener);
    }

    /** Ask for something after which an event follows; resolves with that event. */
    async until(event: string, command: string, options: object = {}): Promise<void> {
        const arrived = new Promise((resolve, reject) => {
            this.expected.set(event, { resolve, reject });
        });
        await Promise.all([arrived, this.request(command, options)]);
    }

    /** The body of the answer; rejected with the reason if there is none. */
    request(command: string, options: object = {}): Promise<unknown> {
        const seq = ++this.count;
        return new Promise((resolve, reject) => {
            this.waiting.set(seq, { resolve, reject });
            const message = { seq, type: "request", command, arguments: options };
            this.writer.write(message as never).catch(reject);
        });
    }

    stop(): void {
        this.process.kill();
    }

    private receive({ type, event, request_seq, success, message, body }: Message): void {
        if (type === "event") {
            this.expected.get(event ?? "")?.resolve(body);
            this.expected.delete(event ?? "");
            this.listeners.get(event ?? "")?.();
        }
        if (type !== "response") return;
        const waiting = this.waiting.get(request_seq ?? 0);
        this.waiting.delete(request_seq ?? 0);
        if (success === true) waiting?.resolve(body);
        else waiting?.reject(new Error(message ?? ""));
    }

    private ended(): void {
        for (const { reject } of [...this.waiting.values(), ...this.expected.values()])
            reject(new Error("The debug adapter has ended."));
        this.waiting.clear();
        this.expected.clear();
        this.onEnd();
    }
}
