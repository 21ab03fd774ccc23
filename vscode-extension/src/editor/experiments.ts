// SPDX-License-Identifier: Apache-2.0
/**
 * Experiments: asks which parameters have which values, runs `as2fm-lsp experiment --live`, and shows its plots while
 * they grow. A click on a point debugs a run with its values.
 */

import * as vscode from "vscode";
import type { FromExperiment, Live, Point, ToExperiment } from "../experiment/contract";
import { run } from "../server/run";
import { ON_STAGE, type Debugging } from "./debugging";
import { askForExperiment, type Experiment } from "./experimentQuestions";
import type { LanguageServer } from "./server";
import { isTrusted } from "./trust";
import { webviewPage, webviewPanel } from "./webviewPage";

export const EXPERIMENT_FILE = ".experiment.toml";
const ERROR_LINES = 6;
/** A greater probability is met by nearly all runs, so that a run that contradicts it would take long to find. */
const NEARLY_CERTAIN = 0.999;

export class Experiments implements vscode.Disposable {
    private readonly panels = new Set<ExperimentPanel>();
    /** The panels of the experiments in files, by the URIs of the files. */
    private readonly ofFiles = new Map<string, ExperimentPanel>();

    constructor(
        private readonly context: vscode.ExtensionContext,
        private readonly server: LanguageServer,
        private readonly debugging: Debugging,
    ) {}

    /** Ask for the values of parameters of a system, and run the experiment. */
    async ask(system: string, parameter?: string): Promise<void> {
        if (!isTrusted()) return;
        const experiment = await askForExperiment(this.server, system, parameter);
        if (experiment) await this.open(experiment);
    }

    /** Run the experiment in a file; again, if it is shown already. */
    async openFile(file: vscode.Uri): Promise<void> {
        if (!isTrusted()) return;
        const key = file.toString();
        const shown = this.ofFiles.get(key);
        if (shown) {
            await shown.again();
            return;
        }
        await this.open({ title: vscode.workspace.asRelativePath(file), arguments: [file.fsPath] }, key);
    }

    private async open(experiment: Experiment, file?: string): Promise<void> {
        const { state } = this.server;
        if (state.kind !== "running") {
            void vscode.window.showErrorMessage(vscode.l10n.t("The language server is not running."));
            return;
        }
        const panel = new ExperimentPanel(experiment, this.context, this.debugging, state.server);
        this.panels.add(panel);
        if (file !== undefined) this.ofFiles.set(file, panel);
        panel.onDispose(() => {
            this.panels.delete(panel);
            if (file !== undefined) this.ofFiles.delete(file);
        });
        await panel.start();
    }

    dispose(): void {
        for (const panel of this.panels) panel.dispose();
    }
}

class ExperimentPanel {
    private readonly panel: vscode.WebviewPanel;
    private running: AbortController | undefined;
    private live: Live | undefined;
    private status = "";

    constructor(
        private readonly experiment: Experiment,
        context: vscode.ExtensionContext,
        private readonly debugging: Debugging,
        private readonly program: { readonly command: string; readonly args: readonly string[] },
    ) {
        const dist = vscode.Uri.joinPath(context.extensionUri, "dist");
        const title = vscode.l10n.t("Experiment: {0}", experiment.title);
        this.panel = webviewPanel(context, dist, "as2fm.experiment", title, vscode.ViewColumn.Beside);
        const { webview } = this.panel;
        webview.onDidReceiveMessage((message: FromExperiment) => void this.receive(message));
        this.panel.onDidDispose(() => this.running?.abort());
        webview.html = webviewPage(webview, dist, "experiment.js", ["view.css", "plot.css", "experiment.css"]);
    }

    onDispose(listener: () => void): void {
        this.panel.onDidDispose(listener);
    }

    dispose(): void {
        this.panel.dispose();
    }

    /** Show the panel, and run the experiment again unless it is running. */
    async again(): Promise<void> {
        this.panel.reveal(undefined, true);
        if (!this.running) await this.start();
    }

    /** Run the experiment, and show each line of its output. */
    async start(): Promise<void> {
        const running = new AbortController();
        this.running = running;
        // The command reads the files from the disk.
        await vscode.workspace.saveAll(false);
        const before = this.live;
        this.show(vscode.l10n.t("Reading the model…"));
        const { command, args } = this.program;
        const ended = await run(command, [...args, "experiment", ...this.experiment.arguments, "--live"], {
            signal: running.signal,
            onLine: (line) => {
                this.take(JSON.parse(line) as Live);
            },
        });
        if (this.running === running) this.running = undefined;
        const { done = 0, total = 0 } = this.live ?? {};
        if (running.signal.aborted) this.show(vscode.l10n.t("Cancelled: {0} of {1} points are known", done, total));
        else if (this.live !== before && done > 0) this.show(vscode.l10n.t("{0} points", done));
        else this.show(ended.err.trim().split("\n").slice(0, ERROR_LINES).join("\n"));
    }

    private take(live: Live): void {
        this.live = live;
        this.post({ type: "live", live });
        this.show(vscode.l10n.t("{0} of {1} points", live.done, live.total));
    }

    private show(status: string): void {
        this.status = status;
        this.post({ type: "status", status, isRunning: this.running !== undefined });
    }

    private post(message: ToExperiment): void {
        void this.panel.webview.postMessage(message);
    }

    private async receive(message: FromExperiment): Promise<void> {
        switch (message.type) {
            case "ready":
                this.post({ type: "words", words: words() });
                if (this.live) this.post({ type: "live", live: this.live });
                this.show(this.status);
                break;
            case "cancel":
                this.running?.abort();
                break;
            case "again":
                if (!this.running) await this.start();
                break;
            case "save":
                await this.save();
                break;
            case "run":
                await this.debug(message.key);
                break;
        }
    }

    /** Debug a run with the setting of a point: one that contradicts the property, if there are such runs. */
    private async debug(key: string): Promise<void> {
        const { live } = this;
        const row = live?.rows.find(({ points }) => points.some((point) => point?.key === key));
        const point = row?.points.find((other) => other?.key === key);
        if (!live || !row || !point) return;
        const { setting } = row;
        const given = live.model.endsWith(".jani") ? { constants: setting } : { parameters: setting };
        const mocks = live.mocks.map((mock) => withValues(mock, setting));
        await this.debugging.start(vscode.Uri.file(live.model), {
            property: point.property,
            ...given,
            ...(mocks.length > 0 ? { mocks } : {}),
            ...runFor(point, live),
            stopOnEntry: true,
            [ON_STAGE]: true,
        });
    }

    /** Save what is shown: the plots, or the points as a table. */
    private async save(): Promise<void> {
        const { live } = this;
        if (!live) return;
        const base = live.model.replace(/\.\w+$/, "");
        const filters = { SVG: ["svg"], CSV: ["csv"], HTML: ["html"] };
        const target = await vscode.window.showSaveDialog({ defaultUri: vscode.Uri.file(`${base}.svg`), filters });
        if (!target) return;
        const saved = filesOf(live, target);
        for (const [uri, text] of saved) await vscode.workspace.fs.writeFile(uri, new TextEncoder().encode(text));
        const [first] = saved;
        if (first) await vscode.commands.executeCommand("vscode.open", first[0]);
    }
}

/** The files with their texts. Several plots have numbers behind the name of the file, as on the command line. */
function filesOf({ files }: Live, target: vscode.Uri): (readonly [uri: vscode.Uri, text: string])[] {
    if (target.path.endsWith(".csv")) return [[target, files.csv]];
    if (target.path.endsWith(".html")) return [[target, files.html]];
    if (files.svg.length === 1) return files.svg.map((text) => [target, text]);
    const stem = target.path.replace(/\.svg$/, "");
    return files.svg.map((text, index) => [target.with({ path: `${stem}_${index + 1}.svg` }), text]);
}

/** Which run shows the property at a point. Only probabilities are about runs that satisfy or contradict a property. */
function runFor(point: Point, live: Live): object {
    const values = live.rows.flatMap(({ points }) => points.map((other) => other?.value ?? 0));
    const areProbabilities = values.every((value) => typeof value === "number" && value >= 0 && value <= 1);
    if (!areProbabilities || typeof point.value !== "number") return { trace: 0 };
    return point.value > NEARLY_CERTAIN ? { inFavor: 1 } : { against: 1 };
}

function withValues(text: string, setting: Readonly<Record<string, string>>): string {
    return text.replaceAll(/\$\(var (\w+)\)/g, (whole, name: string) => setting[name] ?? whole);
}

function words() {
    return {
        cancel: vscode.l10n.t("Cancel"),
        again: vscode.l10n.t("Run Again"),
        save: vscode.l10n.t("Save…"),
        run: vscode.l10n.t("Debug a run with these values"),
        hint: vscode.l10n.t("A click on a point, or on its value below, debugs a run with its values."),
    };
}
