// SPDX-License-Identifier: Apache-2.0
/** What a picture shows, and what happens when the user acts in it; independent of the page that draws it. */

import * as vscode from "vscode";
import { ExecuteCommandRequest } from "vscode-languageserver-protocol";
import type {
    FromView,
    Activity,
    Part,
    Picture,
    PictureFormat,
    PictureKind,
    Place,
    ToView,
    Words,
} from "../pictures/contract";
import { WHOLE } from "../pictures/contract";
import { marked } from "../pictures/breakpoints";
import { partAt } from "../pictures/partAt";
import {
    coverage as coverageRequest,
    mocks as mocksRequest,
    pictureFile,
    picture as pictureRequest,
    setMock,
    VERIFY,
    type Highlight,
    type Mocks,
    type PictureParams,
} from "../protocol";
import { breakpoints, toggle } from "./breakpoints";
import { columnFor } from "./recentEditor";
import type { LanguageServer } from "./server";
import { isTrusted } from "./trust";

/** A node of a picture that is active in a run; `path` is the file of the picture. */
export interface ActiveNode {
    readonly kind: PictureKind;
    readonly path: string;
    readonly node: string;
    readonly look: string;
}

type SetMock = Extract<FromView, { type: "setMock" }>;

/** The page in which a picture is shown. */
export interface PictureHost {
    post(message: ToView): void;
    setTitle(title: string): void;
    /** Give the page the focus. */
    focus(): void;
}

/** A picture that follows its document, and the answers to what the user does in it. */
export class PictureSource {
    uri: vscode.Uri | undefined;
    private picture: Picture | undefined;
    /** Whether the file of the picture was deleted or renamed by another program. */
    private isMissing = false;
    private here: Part | null = null;
    /** The highlighted nodes of the step that was selected last, in all files. */
    highlighted: Highlight | undefined;
    private activeNodes: readonly ActiveNode[] = [];
    private activeEdges: Activity["edges"] = [];
    private shownUri = "";
    private ready = false;
    private asked = 0;
    private mocks: Mocks | null = null;
    private isVerifying = false;
    private mustVerify = false;
    /** The changes of mocks that are not made yet, by their patterns. */
    private readonly changes = new Map<string, SetMock>();
    private isChanging = false;
    private showsCoverage = false;
    onVerified: () => void = () => undefined;
    /** Called when the user undoes a change of the text, or makes it again, while the picture has the focus. */
    onChangeBack: (which: "undo" | "redo") => Promise<void> = () => Promise.resolve();
    /** The ids of the nodes whose descendants are hidden, and the file that they belong to. */
    private readonly collapsed = new Set<string>();
    /** The part of a ROS graph that is shown. */
    private part = WHOLE;
    /** The file for which a part was chosen or nodes were hidden. */
    private chosenIn = "";

    constructor(
        readonly kind: PictureKind,
        private readonly server: LanguageServer,
        private readonly log: vscode.LogOutputChannel,
        readonly host: PictureHost,
    ) {}

    async show(uri: vscode.Uri): Promise<void> {
        this.uri = uri;
        await this.refresh();
    }

    /** Follow a file that the user has renamed in the editor, or whose folder was renamed. */
    rename(files: readonly { readonly oldUri: vscode.Uri; readonly newUri: vscode.Uri }[]): void {
        for (const { oldUri, newUri } of files) {
            const [old, path] = [oldUri.path, this.uri?.path ?? ""];
            if (path === old || path.startsWith(`${old}/`))
                this.uri = this.uri?.with({ path: newUri.path + path.slice(old.length) });
        }
    }

    async refresh(): Promise<void> {
        if (!this.uri) return;
        const asked = ++this.asked;
        const uri = this.uri.toString();
        if (uri !== this.chosenIn) {
            this.collapsed.clear();
            this.part = WHOLE;
        }
        this.chosenIn = uri;
        const picture = await this.server.ask(pictureRequest, this.request(uri));
        const missing = picture === null && (await isMissing(this.uri));
        if (asked !== this.asked || picture === undefined) return;
        this.isMissing = missing;
        this.picture = picture ?? undefined;
        const center = picture?.nodes.find(({ id }) => id === this.part.around)?.label;
        const part = [center, this.part.matching].filter(Boolean).join(", ");
        const title = picture ? `${titleOf(this.kind)}: ${picture.title}${part && ` (${part})`}` : titleOf(this.kind);
        this.host.setTitle(title);
        this.here = this.partAtAnyCaret();
        this.shownUri = this.asServerSays(this.uri);
        this.draw();
        await Promise.all([this.showMocks(), this.showCoverage()]);
    }

    private request(uri: string): PictureParams {
        return { kind: this.kind, textDocument: { uri }, collapsed: [...this.collapsed], ...this.part };
    }

    /** Show what the traces of the last verification have executed, if the user wants to see it. */
    async showCoverage(): Promise<void> {
        if (!this.showsCoverage || !this.uri) return;
        const asked = this.asked;
        const coverage = await this.server.ask(coverageRequest, this.request(this.uri.toString()));
        if (asked === this.asked && coverage !== undefined) this.post({ type: "coverage", coverage });
    }

    /** Show the mocks of the tree. */
    async showMocks(opens = false): Promise<void> {
        if (this.kind !== "tree" || !this.uri) return;
        const asked = this.asked;
        const mocks = await this.server.ask(mocksRequest, { textDocument: { uri: this.uri.toString() } });
        if (asked !== this.asked || mocks === undefined) return;
        this.mocks = mocks;
        this.postMocks(opens);
    }

    private postMocks(opens = false): void {
        this.post({ type: "mocks", mocks: this.mocks, busy: this.isVerifying, opens });
    }

    /**
     * Change a mock in the file beside the tree, and verify the tree again. Changes are made one after the other, because
     * the places of an edit are those of the text before it; of several changes of a mock, only the last one is made.
     */
    private async setMock(message: SetMock): Promise<void> {
        this.changes.set(message.pattern, message);
        if (this.isChanging) return;
        this.isChanging = true;
        try {
            for (let [next] = this.changes.values(); next; [next] = this.changes.values()) {
                this.changes.delete(next.pattern);
                await this.changeMock(next);
            }
        } finally {
            this.isChanging = false;
        }
        await this.verify();
    }

    private async changeMock(message: SetMock): Promise<void> {
        const { client } = this.server;
        if (!this.uri || !client || !isTrusted()) return;
        const { pattern, probability, milliseconds } = message;
        const values = { textDocument: { uri: this.uri.toString() }, pattern, probability, milliseconds };
        const answer = await this.server.ask(setMock, values);
        const edit = await client.protocol2CodeConverter.asWorkspaceEdit(answer?.edit ?? undefined);
        if (!answer || !edit) {
            if (answer) void vscode.window.showErrorMessage(answer.problem);
            return;
        }
        const uri = client.protocol2CodeConverter.asUri(answer.uri);
        if (!(await vscode.workspace.applyEdit(edit))) return;
        // The debugger and the command line read the file from the disk.
        await (await vscode.workspace.openTextDocument(uri)).save();
    }

    /** Verify the tree. A change of a mock during the verification starts another one after it. */
    private async verify(): Promise<void> {
        const { client } = this.server;
        if (!this.uri || !client || !isTrusted()) return;
        this.mustVerify = true;
        if (this.isVerifying) return;
        this.isVerifying = true;
        this.postMocks();
        try {
            while (this.mustVerify) {
                this.mustVerify = false;
                const params = { command: VERIFY, arguments: [this.uri.toString(), [], { silent: true }] };
                await client.sendRequest(ExecuteCommandRequest.type, params);
            }
        } catch (error) {
            this.log.debug(`The tree has no result: ${String(error)}`);
        } finally {
            this.isVerifying = false;
        }
        this.onVerified();
        await this.refresh();
    }

    follow(editor: vscode.TextEditor): void {
        const { uri, languageId } = editor.document;
        const isMachine = languageId === "ascxml" || languageId === "scxml";
        if (this.kind === "machine" && isMachine && uri.scheme === "file" && uri.toString() !== this.uri?.toString()) {
            this.uri = uri;
            void this.refresh();
            return;
        }
        const here = this.partAtCaret(editor);
        if (JSON.stringify(here) === JSON.stringify(this.here)) return;
        this.here = here;
        this.post({ type: "here", here });
    }

    /** Highlight a node; the picture of a machine changes to the machine that contains the node. */
    async highlight(highlighted: Highlight | undefined): Promise<void> {
        this.highlighted = highlighted;
        if (highlighted && this.kind === "machine" && this.shownUri !== highlighted.uri) {
            this.uri = vscode.Uri.parse(highlighted.uri);
            await this.refresh();
        } else this.post({ type: "highlight", node: this.highlightedNode });
    }

    /** The node to highlight. The machine is compared, too, because states of two machines may have the same name. */
    private get highlightedNode(): string {
        return this.highlighted && (this.kind !== "machine" || this.highlighted.uri === this.shownUri)
            ? this.highlighted.node
            : "";
    }

    showActivity(nodes: readonly ActiveNode[], edges: Activity["edges"]): void {
        this.activeNodes = nodes.filter(({ kind }) => kind === this.kind);
        this.activeEdges = this.kind === "ros" ? edges : [];
        this.postLit();
    }

    /** A picture of a machine shows only the activity in its file. */
    private postLit(): void {
        const nodes = this.activeNodes.filter(({ path }) => this.kind !== "machine" || path === this.uri?.fsPath);
        const looks = Object.fromEntries(nodes.map(({ node, look }) => [node, look]));
        this.post({ type: "activity", activity: { nodes: looks, edges: this.activeEdges } });
    }

    private partAtCaret(editor: vscode.TextEditor): Part | null {
        if (!this.picture) return null;
        return partAt(this.picture, this.asServerSays(editor.document.uri), editor.selection.active);
    }

    /** The part at the caret of the active editor, or of a visible editor if the picture has the focus. */
    private partAtAnyCaret(): Part | null {
        const { activeTextEditor, visibleTextEditors } = vscode.window;
        for (const editor of activeTextEditor ? [activeTextEditor] : visibleTextEditors) {
            const part = this.partAtCaret(editor);
            if (part) return part;
        }
        return null;
    }

    /** A URI in the form in which the client sends it to the server, because the server returns URIs in this form. */
    private asServerSays(uri: vscode.Uri): string {
        return this.server.client?.code2ProtocolConverter.asUri(uri) ?? uri.toString();
    }

    private draw(): void {
        if (!this.picture) {
            const name = this.uri ? vscode.workspace.asRelativePath(this.uri) : "";
            const missing = vscode.l10n.t("{0} does not exist any more.", name);
            this.post({ type: "none", reason: this.isMissing ? missing : nothingOf(this.kind) });
            return;
        }
        const { picture, part, here, highlightedNode } = this;
        this.post({ type: "show", picture, part, here, highlighted: highlightedNode });
        this.postMocks();
        this.postLit();
        this.postBreakpoints();
    }

    /** Show which parts have a breakpoint. */
    postBreakpoints(): void {
        if (!this.picture) return;
        const all = breakpoints((uri) => this.asServerSays(uri));
        this.post({ type: "breakpoints", parts: marked(this.picture, all) });
    }

    private post(message: ToView): void {
        if (this.ready) this.host.post(message);
    }

    async receive(message: FromView): Promise<void> {
        switch (message.type) {
            case "ready":
                this.ready = true;
                this.post({ type: "words", words: words() });
                // The server may have answered before, also that there is no picture.
                if (this.shownUri !== "") this.draw();
                break;
            case "collapse":
                if (!this.collapsed.delete(message.node)) this.collapsed.add(message.node);
                await this.refresh();
                break;
            case "part":
                this.part = message.part;
                await this.refresh();
                break;
            case "jump":
                await jump(message.place, message.beside);
                break;
            case "setMock":
                await this.setMock(message);
                break;
            case "verify":
                await this.verify();
                break;
            case "coverage":
                this.showsCoverage = message.shows;
                await this.showCoverage();
                break;
            case "breakpoint":
                toggle(message.breakpoint);
                break;
            case "undo":
            case "redo":
                await this.onChangeBack(message.type);
                break;
            case "save":
                await this.save(message);
                break;
            case "png":
                await this.write("png", Buffer.from(message.data, "base64"));
                break;
            case "drawn":
                this.log.debug(`Drawn: ${message.nodes} nodes, ${message.edges} edges`);
                break;
        }
    }

    /** Request the file from the server. The view converts it to PNG, the server to PDF. */
    private async save({ format, direction, theme }: Extract<FromView, { type: "save" }>): Promise<void> {
        if (!this.uri) return;
        const options = { ...this.request(this.uri.toString()), direction, theme, format };
        const file = await this.server.ask(pictureFile, options);
        if (!file) return;
        if (format === "png") this.post({ type: "rasterize", svg: file.svg });
        else if (file.pdf !== undefined) await this.write("pdf", Buffer.from(file.pdf, "base64"));
        else await this.write("svg", Buffer.from(file.svg, "utf8"));
    }

    private async write(format: PictureFormat, data: Uint8Array): Promise<void> {
        const name = (this.picture?.title ?? this.kind).replace(/\.\w+$/, "").replace(/[^\w.-]+/g, "_");
        const folder = this.uri?.scheme === "file" ? vscode.Uri.joinPath(this.uri, "..") : undefined;
        const file = `${name}.${this.kind}.${format}`;
        const target = await vscode.window.showSaveDialog({
            ...(folder && { defaultUri: vscode.Uri.joinPath(folder, file) }),
            filters: { [format.toUpperCase()]: [format] },
        });
        if (target) await vscode.workspace.fs.writeFile(target, data);
    }
}

export async function jump(place: Place, beside: boolean, preserveFocus = false): Promise<void> {
    const { start, end } = place.range;
    const uri = vscode.Uri.parse(place.uri);
    const viewColumn = beside ? vscode.ViewColumn.Beside : columnFor(uri);
    const editor = await vscode.window.showTextDocument(uri, { viewColumn, preserveFocus });
    const from = new vscode.Position(start.line, start.character);
    editor.selection = new vscode.Selection(from, from);
    const range = new vscode.Range(from, new vscode.Position(end.line, end.character));
    editor.revealRange(range, vscode.TextEditorRevealType.InCenterIfOutsideViewport);
}

async function isMissing(uri: vscode.Uri): Promise<boolean> {
    if (uri.scheme !== "file") return false;
    return vscode.workspace.fs.stat(uri).then(
        () => false,
        (error: unknown) => error instanceof vscode.FileSystemError && error.code === "FileNotFound",
    );
}

export function titleOf(kind: PictureKind): string {
    switch (kind) {
        case "machine":
            return vscode.l10n.t("State Machine");
        case "tree":
            return vscode.l10n.t("Behavior Tree");
        case "ros":
            return vscode.l10n.t("ROS Graph");
        case "system":
            return vscode.l10n.t("State Machines");
    }
}

function nothingOf(kind: PictureKind): string {
    switch (kind) {
        case "machine":
            return vscode.l10n.t("This file contains no state machine.");
        case "tree":
            return vscode.l10n.t("This file contains no behavior tree.");
        case "ros":
        case "system":
            return vscode.l10n.t("This file is not part of a system.");
    }
}

function words(): Words {
    return {
        search: vscode.l10n.t("Search"),
        onlyResults: vscode.l10n.t("Only Results"),
        outline: vscode.l10n.t("Outline"),
        outlineHint: vscode.l10n.t("A Row for Each Node"),
        showAll: vscode.l10n.t("Show All"),
        zoomIn: vscode.l10n.t("Zoom in"),
        zoomOut: vscode.l10n.t("Zoom out"),
        fit: vscode.l10n.t("Fit"),
        saveSvg: vscode.l10n.t("Save as SVG"),
        savePng: vscode.l10n.t("Save as PNG"),
        savePdf: vscode.l10n.t("Save as PDF"),
        nothing: vscode.l10n.t("No results"),
        match: vscode.l10n.t("{0}, result {1} of {2}"),
        help: vscode.l10n.t(
            "Arrow keys move between nodes, T selects the edges that leave a node, Enter opens the source, Shift+F10 the menu, Space collapses a node of a tree, a group of states or a namespace, or shows only the neighbors of a node of a ROS graph, B sets a breakpoint, M goes to the mocks of a tree, + and - zoom, 0 fits the diagram, / searches.",
        ),
        byChance: vscode.l10n.t("random"),
        mock: vscode.l10n.t("mock: probability of success, duration"),
        initial: vscode.l10n.t("initial state"),
        final: vscode.l10n.t("state without a way out"),
        looks: {
            active: vscode.l10n.t("active"),
            next: vscode.l10n.t("takes the next step"),
            message: vscode.l10n.t("receives the next message"),
            running: vscode.l10n.t("running"),
            ticked: vscode.l10n.t("is being ticked"),
            success: vscode.l10n.t("succeeded"),
            failure: vscode.l10n.t("failed"),
            idle: vscode.l10n.t("idle"),
        },
        breakpoint: vscode.l10n.t("breakpoint"),
        mocks: vscode.l10n.t("Mocks"),
        probability: vscode.l10n.t("probability of success"),
        seconds: vscode.l10n.t("duration in seconds"),
        verify: vscode.l10n.t("Verify"),
        unverified: vscode.l10n.t("Not verified"),
        verifying: vscode.l10n.t("Verifying…"),
        coverage: {
            show: vscode.l10n.t("Coverage"),
            hint: vscode.l10n.t("Show what the traces of the last verification have executed"),
            all: vscode.l10n.t("in all {0} traces"),
            some: vscode.l10n.t("in {0} of {1} traces"),
            none: vscode.l10n.t("in none of {0} traces"),
            never: vscode.l10n.t("never"),
            part: vscode.l10n.t("Coverage by the first {0} of {1} traces of {2}"),
            inAll: vscode.l10n.t("in all"),
            inSome: vscode.l10n.t("in some"),
            inNone: vscode.l10n.t("in none"),
            notVerified: vscode.l10n.t("No property has been verified by traces yet."),
            stale: vscode.l10n.t("The files have changed since the verification. Verify again to see the coverage."),
            returned: vscode.l10n.t("returned {0}"),
        },
        kinds: {
            state: vscode.l10n.t("state"),
            choice: vscode.l10n.t("random choice"),
            thread: vscode.l10n.t("action thread"),
            group: vscode.l10n.t("group of states"),
            machine: vscode.l10n.t("state machine"),
            control: vscode.l10n.t("control"),
            decorator: vscode.l10n.t("decorator"),
            action: vscode.l10n.t("action"),
            condition: vscode.l10n.t("condition"),
            subtree: vscode.l10n.t("subtree"),
            variable: vscode.l10n.t("blackboard"),
            namespace: vscode.l10n.t("namespace"),
            node: vscode.l10n.t("node"),
            plugin: vscode.l10n.t("plugin"),
            topic: vscode.l10n.t("topic"),
            service: vscode.l10n.t("service"),
            "action-interface": vscode.l10n.t("ROS action"),
            eventless: vscode.l10n.t("without event"),
            event: vscode.l10n.t("event"),
            ros: vscode.l10n.t("ROS"),
            bt: vscode.l10n.t("behavior tree"),
            child: vscode.l10n.t("child"),
            reads: vscode.l10n.t("reads"),
            writes: vscode.l10n.t("writes"),
            publishes: vscode.l10n.t("publishes"),
            subscribes: vscode.l10n.t("subscribes"),
            serves: vscode.l10n.t("serves"),
            calls: vscode.l10n.t("calls"),
            sends: vscode.l10n.t("sends"),
        },
    };
}
