// SPDX-License-Identifier: Apache-2.0
/** The panel with the stage: one view for a run that is debugged, a counterexample, or a simulation. */

import * as vscode from "vscode";
import type { Activity, PictureKind } from "../pictures/contract";
import { about } from "../protocol";
import {
    PICTURES,
    type Comparison,
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
import { AT_STEP, COMPARED_WITH, ON_STAGE } from "./debugging";
import type { DebugSessions, Run } from "./debugSessions";
import { ComparedRun } from "./comparedRun";
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

/** The run that is shown beside the one that is debugged; both are traces with the same seed. */
export interface ComparedWith {
    readonly trace: number;
    readonly comparison: Comparison;
    /** The picture in which the runs part. */
    readonly picture: PicturePane;
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
        const compared = session.configuration[COMPARED_WITH] as ComparedWith | undefined;
        // The timelines of two runs show them to their ends.
        if (compared) await this.goTo(session, compared.comparison.alignment.here.end);
        const step: unknown = session.configuration[AT_STEP];
        if (typeof step === "number") await this.goTo(session, step);
        await this.open();
    }

    /** Resolves when the run has stopped there. */
    private async goTo(session: vscode.DebugSession, step: number): Promise<void> {
        const stopped = new Promise<void>((resolve) => {
            const waiting = this.sessions.onStopped(() => {
                waiting.dispose();
                resolve();
            });
        });
        await session.customRequest("goToStep", { step });
        await stopped;
    }

    /** The run beside the one that is debugged; undefined if there is none. */
    private async beside({ configuration }: vscode.DebugSession): Promise<ComparedRun | undefined> {
        const compared = configuration[COMPARED_WITH] as ComparedWith | undefined;
        const { state } = this.server;
        if (!compared || state.kind !== "running") return undefined;
        const { end, step } = compared.comparison.alignment.there;
        try {
            const other = { ...configuration, trace: compared.trace };
            return await ComparedRun.start(state.server, other, end, step);
        } catch (error) {
            void vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
            return undefined;
        }
    }

    /** Show the run that is debugged. */
    private async open(): Promise<void> {
        const session = this.sessions.current ?? vscode.debug.activeDebugSession;
        const program: unknown = session?.configuration["program"];
        if (!session || typeof program !== "string") return;
        const compared = session.configuration[COMPARED_WITH] as ComparedWith | undefined;
        const comparedIn = compared && session.id;
        const uri = vscode.Uri.file(program);
        const kinds = await this.kindsOf(uri);
        if (this.panel?.shows(uri, comparedIn)) {
            this.panel.reveal();
            return;
        }
        this.panel?.dispose();
        const beside = await this.beside(session);
        await this.makeSpace(beside ? 0.27 : 0.34);
        const about = { uri, kinds, compared, comparedIn };
        const panel = new StagePanel(about, this.context, this.sessions, beside, this.server, this.log);
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
    private async makeSpace(size: number): Promise<void> {
        await vscode.commands.executeCommand("workbench.action.closePanel");
        await vscode.commands.executeCommand("vscode.setEditorLayout", {
            orientation: 0,
            groups: [{ size }, { size: 1 - size }],
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

/** What a panel shows. */
interface Shown {
    readonly uri: vscode.Uri;
    readonly kinds: readonly PicturePane[];
    readonly compared: ComparedWith | undefined;
    /** The id of the session whose run is compared; undefined if the panel follows any session. */
    readonly comparedIn: string | undefined;
}

/** The page of the panel, as one of the runs uses it. */
interface Page {
    readonly post: (message: ToStage) => void;
    readonly focus: () => void;
}

class StagePanel {
    private readonly panel: vscode.WebviewPanel;
    private readonly runs: { readonly here: RunOnStage; readonly there?: RunOnStage };
    private readonly subscriptions: { dispose(): unknown }[];

    constructor(
        private readonly about: Shown,
        context: vscode.ExtensionContext,
        sessions: DebugSessions,
        beside: ComparedRun | undefined,
        server: LanguageServer,
        log: vscode.LogOutputChannel,
    ) {
        const dist = vscode.Uri.joinPath(context.extensionUri, "dist");
        const title = vscode.l10n.t("Stage: {0}", vscode.workspace.asRelativePath(about.uri));
        const column = { viewColumn: vscode.ViewColumn.Two, preserveFocus: false };
        this.panel = webviewPanel(context, dist, "as2fm.stage", title, column);
        const { webview } = this.panel;
        const focus = () => {
            this.panel.reveal();
        };
        const page: Page = {
            post: (message) => {
                this.post(message);
            },
            focus,
        };
        const { kinds } = about;
        const shown = beside && about.compared ? [about.compared.picture, "timeline" as const] : undefined;
        const here = new RunOnStage(kinds, sessions, moveSession(sessions), page, server, log, shown);
        this.subscriptions = [here, webview.onDidReceiveMessage((message: FromStage) => void this.receive(message))];
        if (beside) {
            const pageThere: Page = {
                post: (message) => {
                    this.post({ to: "there", message });
                },
                focus,
            };
            const there = new RunOnStage(kinds, beside, () => Promise.resolve(), pageThere, server, log, shown);
            this.runs = { here, there };
            const ended = sessions.onEnded(({ id }) => {
                if (id === about.comparedIn) beside.dispose();
            });
            const showActivity = beside.onStopped(() => void there.showActivity());
            this.subscriptions.push(beside, there, ended, showActivity);
        } else this.runs = { here };
        this.panel.onDidDispose(() => {
            for (const part of this.subscriptions) part.dispose();
        });
        webview.html = webviewPage(webview, dist, "stage.js", ["view.css", "timeline.css", "stage.css"]);
    }

    /** The pictures that show the run that is debugged. */
    get sources(): Iterable<PictureSource> {
        return this.runs.here.sources;
    }

    shows(uri: vscode.Uri, comparedIn: string | undefined): boolean {
        return this.about.uri.toString() === uri.toString() && this.about.comparedIn === comparedIn;
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
        const { here, there } = this.runs;
        for (const source of [...here.sources, ...(there?.sources ?? [])]) await source.show(this.about.uri);
    }

    private post(message: ToStage): void {
        void this.panel.webview.postMessage(message);
    }

    private async receive(message: FromStage): Promise<void> {
        const { here, there } = this.runs;
        const { compared } = this.about;
        if (message.from === "there") await there?.receive(message.message);
        else if (message.from === "ready") {
            if (there && compared) this.post({ to: "compare", comparison: compared.comparison });
            await here.begin();
            await there?.begin();
            await there?.showActivity();
        } else await here.receive(message);
    }
}

/** One of the runs on the stage: its pictures, its timeline, its properties. */
class RunOnStage implements vscode.Disposable {
    private readonly bySource = new Map<PicturePane, PictureSource>();
    private readonly timeline: TimelineSource;
    private readonly subscriptions: { dispose(): unknown }[];

    /** `shown` are the panes that are shown first; all if undefined. */
    constructor(
        private readonly kinds: readonly PicturePane[],
        private readonly run: Run,
        private readonly move: (move: Move) => Promise<void>,
        private readonly page: Page,
        server: LanguageServer,
        log: vscode.LogOutputChannel,
        private readonly shown: readonly Pane[] | undefined,
    ) {
        for (const kind of kinds) {
            const host: PictureSource["host"] = {
                post: (message) => {
                    page.post({ to: kind, message });
                },
                setTitle: () => undefined,
                focus: page.focus,
            };
            this.bySource.set(kind, new PictureSource(kind, server, log, host));
        }
        this.timeline = new TimelineSource(run, (message) => {
            page.post({ to: "timeline", message });
        });
        this.subscriptions = [
            this.timeline,
            run.onStopped(() => void this.stopped()),
            run.onEnded(() => {
                page.post({ to: "ended" });
            }),
        ];
    }

    get sources(): Iterable<PictureSource> {
        return this.bySource.values();
    }

    dispose(): void {
        for (const part of this.subscriptions) part.dispose();
    }

    /** Fill the page, which is ready. */
    async begin(): Promise<void> {
        const panes: readonly Pane[] = [...this.kinds, "timeline", "properties"];
        const shown = panes.filter((pane) => this.shown?.includes(pane) ?? true);
        this.page.post({ to: "words", words: words(), panes, shown });
        for (const source of this.sources) await source.receive({ type: "ready" });
        await this.timeline.receive({ type: "ready" });
        await this.stopped();
    }

    async receive(message: FromStage): Promise<void> {
        switch (message.from) {
            case "timeline":
                await this.timeline.receive(message.message);
                break;
            case "move":
                await this.move(message.move);
                break;
            case "ask":
                this.page.post({ to: "moments", asked: message.asked, moments: await this.moments(message.asked) });
                break;
            case "jump":
                await jump(message.place, false);
                break;
            case "system":
            case "tree":
            case "ros":
                await this.bySource.get(message.from)?.receive(message.message);
                break;
            case "ready":
            case "there":
                break; // for the panel
        }
    }

    /** Show in the pictures what is active. */
    async showActivity(): Promise<void> {
        try {
            const answer = (await this.run.current?.customRequest("pictures")) as Answer | undefined;
            if (answer) for (const source of this.sources) source.showActivity(activeNodes(answer), answer.edges);
        } catch {
            // The run is moving again; its activity is shown where it stops.
        }
    }

    /** Tell the page where the run has stopped. */
    private async stopped(): Promise<void> {
        const session = this.run.current;
        if (!session) {
            this.page.post({ to: "ended" });
            return;
        }
        try {
            const choices = (await session.customRequest("choices")) as Choices;
            const { properties } = (await session.customRequest("properties")) as {
                readonly properties: readonly PropertyAnswer[];
            };
            const next = choices.choices.find(({ isNext }) => isNext)?.text ?? "";
            const ended = choices.end === null ? "" : vscode.l10n.t("The run has ended: {0}.", choices.end);
            this.page.post({
                to: "stopped",
                state: {
                    step: choices.step,
                    time: choices.time,
                    next: choices.fault ?? (ended === "" && next !== "" ? vscode.l10n.t("Next: {0}", next) : ended),
                    isEnd: choices.end !== null || choices.fault !== null,
                    properties: properties.map(propertyOf),
                },
            });
        } catch {
            // The run is moving again; it is shown where it stops.
        }
    }

    private async moments(asked: MomentsRequest): Promise<readonly Moment[] | null> {
        try {
            const answer = (await this.run.current?.customRequest("moments", asked)) as
                { readonly moments: readonly MomentAnswer[] } | undefined;
            return answer?.moments.map(momentOf) ?? null;
        } catch {
            return null;
        }
    }
}

/** Move the run that is debugged, as the buttons of VS Code do. */
function moveSession(sessions: DebugSessions): (move: Move) => Promise<void> {
    const run = async (command: string) => {
        await vscode.commands.executeCommand(`workbench.action.debug.${command}`);
    };
    return async (move) => {
        switch (move) {
            case "toStart":
                await sessions.request("goToStep", { step: 0 });
                break;
            case "reverse":
                await run("reverseContinue");
                break;
            case "stepBack":
                await run("stepBack");
                break;
            case "stepForward":
                await run("stepInto");
                break;
            case "continue":
                await run("continue");
                break;
        }
    };
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
