// SPDX-License-Identifier: Apache-2.0
/** A run that is shown beside the one that is debugged. It has no debug session of VS Code, which would show it twice. */

import * as vscode from "vscode";
import { DebugAdapter } from "../server/debugAdapter";
import type { Server } from "../server/server";
import type { Run } from "./debugSessions";

export class ComparedRun implements Run, vscode.Disposable {
    private readonly stopped = new vscode.EventEmitter<undefined>();
    private readonly ended = new vscode.EventEmitter<undefined>();
    private readonly adapter: DebugAdapter;
    private isStopped = false;
    readonly onStopped = this.stopped.event;
    readonly onEnded = this.ended.event;

    private constructor(
        { command, args }: Server,
        private readonly configuration: vscode.DebugConfiguration,
    ) {
        this.adapter = new DebugAdapter(command, [...args, "debug"], () => {
            this.isStopped = false;
            this.ended.fire(undefined);
        });
    }

    /** Start a run and go to a step, after the run has taken all its steps. Rejected with the reason if it fails. */
    static async start(
        server: Server,
        configuration: vscode.DebugConfiguration,
        end: number,
        step: number,
    ): Promise<ComparedRun> {
        const run = new ComparedRun(server, configuration);
        const { adapter } = run;
        try {
            await adapter.request("initialize", { adapterID: configuration.type, pathFormat: "path" });
            await adapter.request("launch", configuration);
            await adapter.until("stopped", "configurationDone");
            for (const goal of [end, step]) await adapter.until("stopped", "goToStep", { step: goal });
        } catch (error) {
            run.dispose();
            throw error;
        }
        run.isStopped = true;
        adapter.on("stopped", () => {
            run.stopped.fire(undefined);
        });
        return run;
    }

    get current(): Run["current"] {
        if (!this.isStopped) return undefined;
        return {
            configuration: this.configuration,
            customRequest: (command, options?: object) => this.adapter.request(command, options),
        };
    }

    async request(command: string, options: object): Promise<unknown> {
        try {
            return await this.current?.customRequest(command, options);
        } catch (error) {
            void vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
            return undefined;
        }
    }

    dispose(): void {
        this.adapter.stop();
        for (const part of [this.stopped, this.ended]) part.dispose();
    }
}
