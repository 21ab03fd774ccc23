// SPDX-License-Identifier: Apache-2.0
/** The panel with the stage: one view for a run that is debugged, a counterexample, or a simulation. */

import * as vscode from "vscode";
import type { Activity, PictureKind } from "../pictures/contract";
import { about } from "../protocol";
import {
    PICTURES,
    type FromStage,
    type Moment,
    type MomentsRequest,
    type Move,
    type Pane,
    type PicturePane,
    type StageProperty,
    type StageWords,
    type ToStage,
    type Verdict,
} from "../stage/contract";
import { AT_STEP, ON_STAGE } from "./debugging";
import type { DebugSessions } from "./debugSessions";
import { activeNodes, type Answer } from "./pictureActivity";
import type { PicturePanels } from "./picturePanels";
import { jump, PictureSource, type ActiveNode } from "./pictureSource";
import type { LanguageServer } from "./server";
import { TimelineSource } from "./timeline";
import { webviewPage, webviewPanel } from "./webviewPage";

type MomentAnswer = Answer & Omit<Moment, "activity">;

interface PropertyAnswer extends Omit<StageProperty, "place"> {
    readonly source?: { readonly path: string };
    readonly line?: number;
    readonly column?: number;
}

/** The part of the answer to `choices` that the stage shows. */
interface Choices {
    readonly step: number;
    readonly time: number | null;
    readonly end: string | null;
    readonly fault: string | null;
    readonly choices: readonly { readonly text: string; readonly isNext: boolean }[];
}

export class Stage implements vscode.Disposable {
    private readonly subscriptions: vscode.Disposable[];
    private panel: StagePanel | undefined;
    /** The ids of the sessions for which the stage has been opened. */
    private readonly opened = new Set<string>();

    constructor(
        private readonly context: vscode.ExtensionContext,
        private readonly sessions: DebugSessions,
        private readonly pictures: PicturePanels,
        private readonly server: LanguageServer,
        private readonly log: vscode.LogOutputChannel,
    ) {
        this.subscriptions = [
            vscode.commands.registerCommand("as2fm.showRun", () => this.open()),
            sessions.onStopped((session) => {
                if (session.configuration[ON_STAGE] !== true || this.opened.has(session.id)) return;
                this.opened.add(session.id);
                void this.begin(session);
            }),
        ];
    }

    dispose(): void {
        this.panel?.dispose();
        for (const part of this.subscriptions) part.dispose();
    }

    private async begin(session: vscode.DebugSession): Promise<void> {
        await this.open();
        const step: unknown = session.configuration[AT_STEP];
        if (typeof step === "number") await session.customRequest("goToStep", { step });
    }

    /** Show the run that is debugged. */
    private async open(): Promise<void> {
        const session = this.sessions.current ?? vscode.debug.activeDebugSession;
        const program: unknown = session?.configuration["program"];
        if (typeof program !== "string") return;
        const uri = vscode.Uri.file(program);
        const kinds = await this.kindsOf(uri);
        if (this.panel?.shows(uri)) {
            this.panel.reveal();
            return;
        }
        this.panel?.dispose();
        await this.makeSpace();
        const panel = new StagePanel(uri, kinds, this.context, this.sessions, this.server, this.log);
        this.panel = panel;
        for (const source of panel.sources) this.pictures.add(source);
        panel.onDispose(() => {
            for (const source of panel.sources) this.pictures.remove(source);
            if (this.panel === panel) this.panel = undefined;
        });
        // Sources are opened beside the stage, not above it.
        await vscode.commands.executeCommand("workbench.action.lockEditorGroup");
        await vscode.commands.executeCommand("workbench.action.focusFirstEditorGroup");
        await panel.show();
    }

    /** The source on the left, the stage on the right; it has the timeline, so that the panel below is not needed. */
    private async makeSpace(): Promise<void> {
        await vscode.commands.executeCommand("workbench.action.closePanel");
        await vscode.commands.executeCommand("vscode.setEditorLayout", {
            orientation: 0,
            groups: [{ size: 0.34 }, { size: 0.66 }],
        });
    }

    /** The kinds of pictures of a model that is debugged: a tree without a system has only its own, a JANI model none. */
    private async kindsOf(uri: vscode.Uri): Promise<readonly PicturePane[]> {
        const { kind, hasTree } = (await this.server.ask(about, { textDocument: { uri: uri.toString() } })) ?? {};
        if (kind === "tree") return ["tree"];
        if (kind === "system") return hasTree ? PICTURES : ["system", "ros"];
        return [];
    }
}

class StagePanel {
    private readonly panel: vscode.WebviewPanel;
    private readonly bySource = new Map<PicturePane, PictureSource>();
    private readonly timeline: TimelineSource;
    private readonly subscriptions: { dispose(): unknown }[];

    constructor(
        private readonly uri: vscode.Uri,
        private readonly kinds: readonly PicturePane[],
        context: vscode.ExtensionContext,
        private readonly sessions: DebugSessions,
        server: LanguageServer,
        log: vscode.LogOutputChannel,
    ) {
        const dist = vscode.Uri.joinPath(context.extensionUri, "dist");
        const title = vscode.l10n.t("Stage: {0}", vscode.workspace.asRelativePath(uri));
        const column = { viewColumn: vscode.ViewColumn.Two, preserveFocus: false };
        this.panel = webviewPanel(context, dist, "as2fm.stage", title, column);
        const { webview } = this.panel;
        for (const kind of kinds) {
            const post = (message: Parameters<PictureSource["host"]["post"]>[0]) => {
                this.post({ to: kind, message });
            };
            this.bySource.set(kind, new PictureSource(kind, server, log, { post, setTitle: () => undefined }));
        }
        this.timeline = new TimelineSource(sessions, (message) => {
            this.post({ to: "timeline", message });
        });
        this.subscriptions = [
            this.timeline,
            sessions.onStopped(() => void this.stopped()),
            sessions.onEnded(() => {
                this.post({ to: "ended" });
            }),
            webview.onDidReceiveMessage((message: FromStage) => void this.receive(message)),
        ];
        this.panel.onDidDispose(() => {
            for (const part of this.subscriptions) part.dispose();
        });
        webview.html = webviewPage(webview, dist, "stage.js", ["view.css", "timeline.css", "stage.css"]);
    }

    get sources(): Iterable<PictureSource> {
        return this.bySource.values();
    }

    shows(uri: vscode.Uri): boolean {
        return this.uri.toString() === uri.toString();
    }

    reveal(): void {
        this.panel.reveal(undefined, true);
    }

    onDispose(listener: () => void): void {
        this.panel.onDidDispose(listener);
    }

    dispose(): void {
        this.panel.dispose();
    }

    async show(): Promise<void> {
        for (const source of this.sources) await source.show(this.uri);
    }

    private post(message: ToStage): void {
        void this.panel.webview.postMessage(message);
    }

    private async receive(message: FromStage): Promise<void> {
        switch (message.from) {
            case "ready":
                this.post({ to: "words", words: words(), panes: [...this.kinds, "timeline", "properties"] });
                for (const source of this.sources) await source.receive({ type: "ready" });
                await this.timeline.receive({ type: "ready" });
                await this.stopped();
                break;
            case "timeline":
                await this.timeline.receive(message.message);
                break;
            case "move":
                await this.move(message.move);
                break;
            case "ask":
                this.post({ to: "moments", asked: message.asked, moments: await this.moments(message.asked) });
                break;
            case "jump":
                await jump(message.place, false);
                break;
            case "system":
            case "tree":
            case "ros":
                await this.bySource.get(message.from)?.receive(message.message);
        }
    }

    private async move(move: Move): Promise<void> {
        switch (move) {
            case "toStart":
                await this.sessions.request("goToStep", { step: 0 });
                break;
            case "reverse":
                await vscode.commands.executeCommand("workbench.action.debug.reverseContinue");
                break;
            case "stepBack":
                await vscode.commands.executeCommand("workbench.action.debug.stepBack");
                break;
            case "stepForward":
                await vscode.commands.executeCommand("workbench.action.debug.stepInto");
                break;
            case "continue":
                await vscode.commands.executeCommand("workbench.action.debug.continue");
                break;
        }
    }

    /** Tell the page where the run has stopped. */
    private async stopped(): Promise<void> {
        const session = this.sessions.current;
        if (!session) {
            this.post({ to: "ended" });
            return;
        }
        try {
            const choices = (await session.customRequest("choices")) as Choices;
            const { properties } = (await session.customRequest("properties")) as {
                readonly properties: readonly PropertyAnswer[];
            };
            const next = choices.choices.find(({ isNext }) => isNext)?.text ?? "";
            const ended = choices.end === null ? "" : vscode.l10n.t("The run has ended: {0}.", choices.end);
            this.post({
                to: "stopped",
                state: {
                    step: choices.step,
                    time: choices.time,
                    next: choices.fault ?? (ended === "" && next !== "" ? vscode.l10n.t("Next: {0}", next) : ended),
                    properties: properties.map(propertyOf),
                },
            });
        } catch {
            // The run is moving again; it is shown where it stops.
        }
    }

    private async moments(asked: MomentsRequest): Promise<readonly Moment[] | null> {
        try {
            const answer = (await this.sessions.current?.customRequest("moments", asked)) as
                { readonly moments: readonly MomentAnswer[] } | undefined;
            return answer?.moments.map(momentOf) ?? null;
        } catch {
            return null;
        }
    }
}

function momentOf({ step, position, time, isEnd, stop, verdicts, ...answer }: MomentAnswer): Moment {
    const nodes = activeNodes(answer);
    const activity = (kind: PictureKind): Activity => ({
        nodes: looksOf(nodes, kind),
        edges: kind === "ros" ? answer.edges : [],
    });
    const all = { system: activity("system"), tree: activity("tree"), ros: activity("ros") };
    return { step, position, time, isEnd, stop, verdicts, activity: all };
}

function looksOf(nodes: readonly ActiveNode[], kind: PictureKind): Record<string, string> {
    return Object.fromEntries(nodes.filter((node) => node.kind === kind).map(({ node, look }) => [node, look]));
}

/** Lines and columns of the debug adapter begin with 1. */
function propertyOf({ name, text, verdict, source, line, column }: PropertyAnswer): StageProperty {
    const at = { line: (line ?? 1) - 1, character: (column ?? 1) - 1 };
    const place = source && { uri: vscode.Uri.file(source.path).toString(), range: { start: at, end: at } };
    return { name, text, verdict, place: place ?? null };
}

function words(): StageWords {
    const verdicts: Record<Verdict, string> = {
        passed: vscode.l10n.t("holds"),
        failed: vscode.l10n.t("does not hold"),
        undecided: vscode.l10n.t("not decided yet"),
    };
    const panes: Record<Pane, string> = {
        system: vscode.l10n.t("Machines"),
        tree: vscode.l10n.t("Tree"),
        ros: vscode.l10n.t("ROS Graph"),
        timeline: vscode.l10n.t("Timeline"),
        properties: vscode.l10n.t("Properties"),
    };
    return {
        moves: {
            toStart: vscode.l10n.t("Go to the Start"),
            reverse: vscode.l10n.t("Back to the Previous Breakpoint"),
            stepBack: vscode.l10n.t("Step Back (,)"),
            stepForward: vscode.l10n.t("Step Forward (.)"),
            continue: vscode.l10n.t("Continue to the Next Breakpoint"),
        },
        panes,
        play: vscode.l10n.t("Play (P)"),
        pause: vscode.l10n.t("Pause (P)"),
        speed: vscode.l10n.t("Speed"),
        stepsPerSecond: vscode.l10n.t("steps/s"),
        realTime: vscode.l10n.t("real time"),
        fit: vscode.l10n.t("Fit"),
        search: vscode.l10n.t("Search"),
        step: vscode.l10n.t("Step"),
        verdicts,
        noProperties: vscode.l10n.t("This run has no properties."),
        nothing: vscode.l10n.t("No run is being debugged."),
    };
}
