// SPDX-License-Identifier: Apache-2.0
/** Properties in the Test Explorer: a system is a suite, a property is a test, and running a test verifies it. */

import { randomUUID } from "node:crypto";
import * as vscode from "vscode";
import { ExecuteCommandRequest, ProgressType } from "vscode-languageserver-protocol";
import {
    properties,
    SHOW_FIRST_ERROR,
    STUCK,
    VERIFY,
    type Property,
    type VerifiableSystem,
    type Verification,
    type Verified,
    type Wrong,
} from "../protocol";
import { outcomeOf } from "../verification/outcome";
import { chosen } from "../verification/selection";
import { SHOW_COUNTEREXAMPLE, SHOW_WITNESS } from "./client";
import type { Debugging, Trace } from "./debugging";
import type { LanguageServer } from "./server";
import { done } from "./steps";
import { isTrusted } from "./trust";

const DELAY_MS = 300;

/** A property of a system. */
export interface Asked {
    readonly system: string;
    readonly property: string;
    /** The trace that contradicts its expectation, if it is known. */
    readonly trace?: Trace;
}

export class PropertyTests implements vscode.Disposable {
    private readonly controller: vscode.TestController;
    private readonly subscriptions: { dispose(): unknown }[];
    private readonly askedBy = new WeakMap<vscode.TestItem, Asked>();
    /** The expectations of the shown results, by the id of the test. */
    private readonly judged = new Map<string, string>();
    private readonly running = new Set<string>();
    private readonly stale = new Set<string>();
    /** Why systems, and properties by the ids of their tests, were not verified when that was tried last. */
    private readonly obstacles = new Map<string, readonly string[]>();
    /** Settings of the verification that is started next. */
    private options: object = {};
    private readonly toldStuck = new WeakMap<vscode.TestRun, Set<string>>();
    private timer: NodeJS.Timeout | undefined;
    private readonly systems = new vscode.EventEmitter<readonly VerifiableSystem[]>();
    /** The systems with their properties and known results, whenever they may have changed. */
    readonly onSystems = this.systems.event;
    private readonly verifying = new vscode.EventEmitter<undefined>();
    /** Fires when properties begin to be verified, and when that ends. */
    readonly onVerifying = this.verifying.event;
    /** The systems with their properties that were known last. */
    known: readonly VerifiableSystem[] = [];

    constructor(
        private readonly server: LanguageServer,
        private readonly debugging: Debugging,
        private readonly log: vscode.LogOutputChannel,
    ) {
        this.controller = vscode.tests.createTestController("as2fm", vscode.l10n.t("AS2FM properties"));
        this.controller.refreshHandler = () => this.refresh();
        const profile = this.controller.createRunProfile(
            vscode.l10n.t("Verify"),
            vscode.TestRunProfileKind.Run,
            (request, token) => this.run(request, token),
            true,
        );
        const debug = this.controller.createRunProfile(
            vscode.l10n.t("Debug Counterexample"),
            vscode.TestRunProfileKind.Debug,
            (request) => this.debug(request),
        );
        const soon = () => {
            this.refreshSoon();
        };
        this.subscriptions = [
            this.controller,
            this.systems,
            this.verifying,
            profile,
            debug,
            server.onModels(() => {
                this.obstacles.clear();
                soon();
            }),
            // A tree without a system is listed when it is open.
            vscode.languages.onDidChangeDiagnostics(soon),
        ];
    }

    /** Verify properties of a system, all if `names` is empty. Returns whether there are any. */
    async verify(system: string, names: readonly string[]): Promise<boolean> {
        await this.refresh();
        const suite = this.controller.items.get(system);
        if (!suite) return false;
        const named = names
            .map((name) => suite.children.get(testId(system, name)))
            .filter((item) => item !== undefined);
        if (named.length === 0) await reveal(suite);
        const none = new vscode.CancellationTokenSource();
        await this.run(new vscode.TestRunRequest(named.length > 0 ? named : [suite]), none.token);
        none.dispose();
        // If the system has errors, the command opens the first one, in any of its files; otherwise it does nothing.
        await vscode.commands.executeCommand(SHOW_FIRST_ERROR, system);
        return true;
    }

    /** Verify a property with an interval of half the width. */
    async verifyMore({ system, property }: Asked, epsilon: number): Promise<void> {
        this.options = { epsilon: epsilon / 2 };
        try {
            await this.verify(system, [property]);
        } finally {
            this.options = {};
        }
    }

    /** The property that a lens, a message, a test or a row of the results denotes. */
    asked(of: string | vscode.TestItem | Asked, property: string): Asked | undefined {
        if (typeof of === "string") return { system: of, property };
        return "system" in of ? of : this.askedBy.get(of);
    }

    isBeingVerified({ system, property }: Asked): boolean {
        return this.running.has(testId(system, property));
    }

    /** Why a system, or one of its properties, was not verified when that was tried last: the errors in its files, or
     * that of the property. */
    obstaclesOf(system: string, property?: string): readonly string[] {
        return this.obstacles.get(property === undefined ? system : testId(system, property)) ?? [];
    }

    dispose(): void {
        clearTimeout(this.timer);
        for (const subscription of this.subscriptions) subscription.dispose();
    }

    // ------------------------------------------------------------------- the tree

    private refreshSoon(): void {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => void this.refresh(), DELAY_MS);
    }

    /** Update the systems and their properties. */
    async refresh(): Promise<void> {
        const systems = await this.server.ask(properties, null);
        if (systems === undefined) return;
        this.known = systems;
        this.systems.fire(systems);
        const known = new Set(systems.map(({ uri }) => uri));
        this.controller.items.forEach((item) => {
            if (!known.has(item.id)) this.controller.items.delete(item.id);
        });
        for (const system of systems) this.showSystem(system);
    }

    private showSystem({ uri, properties: all }: VerifiableSystem): void {
        const place = this.uri(uri);
        let suite = this.controller.items.get(uri);
        if (!suite) {
            suite = this.controller.createTestItem(uri, vscode.workspace.asRelativePath(place), place);
            this.controller.items.add(suite);
        }
        // With several folders, a path begins with the name of its folder.
        suite.label = vscode.workspace.asRelativePath(place);
        const ids = new Set(all.map(({ name }) => testId(uri, name)));
        suite.children.forEach((item) => {
            if (!ids.has(item.id)) suite.children.delete(item.id);
        });
        for (const [index, property] of all.entries()) this.showProperty(suite, uri, property, index);
    }

    private showProperty(suite: vscode.TestItem, system: string, property: Property, index: number): void {
        const id = testId(system, property.name);
        const place = this.uri(property.uri);
        let item = suite.children.get(id);
        if (item?.uri?.toString() !== place.toString()) {
            item = this.controller.createTestItem(id, property.name, place);
            suite.children.add(item);
            this.askedBy.set(item, { system, property: property.name });
        }
        item.range = rangeOf(property.range);
        // In the order of the files, not by name.
        item.sortText = String(index).padStart(6, "0");
        const wasStale = this.stale.has(id);
        if (property.stale && !wasStale) {
            this.stale.add(id);
            this.controller.invalidateTestResults(item);
        } else if (!property.stale) this.stale.delete(id);
        if (item.description !== undefined)
            item.description = marked(item.description, vscode.l10n.t("stale"), property.stale === true);
        if (property.result && property.stale === false) this.compareAgain(item, property.result);
    }

    /** Show a known result again after a change of its expectations. */
    private compareAgain(item: vscode.TestItem, result: Verified): void {
        const asked = this.askedBy.get(item);
        const before = this.judged.get(item.id);
        if (!asked || before === undefined || before === expectedOf(result) || this.running.has(item.id)) return;
        const run = this.controller.createTestRun(new vscode.TestRunRequest([item]), undefined, false);
        this.show(run, item, asked, result);
        run.end();
    }

    private uri(uri: string): vscode.Uri {
        return this.server.client?.protocol2CodeConverter.asUri(uri) ?? vscode.Uri.parse(uri);
    }

    // ------------------------------------------------------------------- running

    private async run(request: vscode.TestRunRequest, token: vscode.CancellationToken): Promise<void> {
        if (!isTrusted()) return;
        const items = chosen(this.controller.items, request.include, request.exclude);
        const run = this.controller.createTestRun(request);
        const cancel = new vscode.CancellationTokenSource();
        const both = [token, run.token].map((source) =>
            source.onCancellationRequested(() => {
                cancel.cancel();
            }),
        );
        for (const item of items) run.enqueued(item);
        const bySystem = new Map<string, vscode.TestItem[]>();
        for (const item of items) {
            const system = this.askedBy.get(item)?.system;
            if (system !== undefined) bySystem.set(system, [...(bySystem.get(system) ?? []), item]);
        }
        try {
            for (const [system, tests] of bySystem) {
                if (cancel.token.isCancellationRequested) for (const item of tests) this.skip(run, item);
                else await this.runSystem(run, system, tests, cancel.token);
            }
        } finally {
            run.end();
            for (const disposable of [...both, cancel]) disposable.dispose();
        }
        await this.refresh();
    }

    /** Debug a run in which the first of the properties does not hold. */
    private async debug(request: vscode.TestRunRequest): Promise<void> {
        const [item] = chosen(this.controller.items, request.include, request.exclude);
        const asked = item && this.askedBy.get(item);
        if (asked) await this.debugging.counterexample(this.uri(asked.system), asked.property, undefined);
    }

    /** Verify properties of a system together, so that they share traces. Each result is shown when it is complete. */
    private async runSystem(
        run: vscode.TestRun,
        system: string,
        items: readonly vscode.TestItem[],
        token: vscode.CancellationToken,
    ): Promise<void> {
        const open = new Map<string, vscode.TestItem>();
        for (const item of items) {
            const property = this.askedBy.get(item)?.property;
            if (property !== undefined) open.set(property, item);
            run.started(item);
            item.busy = true;
            this.running.add(item.id);
        }
        this.verifying.fire(undefined);
        const all = new Map(open);
        const take = (result: Verified) => {
            const item = open.get(result.property);
            if (!item) return;
            open.delete(result.property);
            this.obstacles.set(item.id, result.error ? [result.error.message] : []);
            item.busy = false;
            this.show(run, item, { system, property: result.property }, result);
        };
        try {
            const answer = await this.ask(system, [...open.keys()], token, take);
            for (const result of answer?.results ?? []) {
                take(result);
                const item = all.get(result.property);
                // Only the complete answer contains whether the system gets stuck.
                if (item && answer?.stuck?.example)
                    this.show(run, item, { system, property: result.property }, result, answer.stuck);
            }
            this.obstacles.set(system, answer?.errors.map(({ message }) => message) ?? []);
            for (const item of open.values()) {
                const wrong = answer?.errors.map((error) => this.wrong(error)) ?? [];
                if (wrong.length > 0) run.errored(item, wrong);
                else this.skip(run, item);
            }
        } catch (error) {
            this.log.debug(`${system} has no answer: ${String(error)}`);
            for (const item of open.values()) {
                if (token.isCancellationRequested) this.skip(run, item);
                else run.errored(item, new vscode.TestMessage(String(error)));
            }
        } finally {
            for (const item of items) {
                item.busy = false;
                this.running.delete(item.id);
                // What is shown now is new, but may be stale: the text has changed meanwhile, or the run was cancelled.
                this.stale.delete(item.id);
            }
            this.verifying.fire(undefined);
        }
    }

    /** End a test without a result. The result that is known, if there is one, is shown again. */
    private skip(run: vscode.TestRun, item: vscode.TestItem): void {
        run.skipped(item);
        if (this.judged.has(item.id)) this.judged.set(item.id, "");
    }

    private async ask(
        system: string,
        names: readonly string[],
        token: vscode.CancellationToken,
        take: (result: Verified) => void,
    ): Promise<Verification | null> {
        const { client } = this.server;
        if (!client) throw new Error(vscode.l10n.t("The language server is not running."));
        const partialResultToken = randomUUID();
        const parts = client.onProgress(new ProgressType<Verified>(), partialResultToken, take);
        try {
            const options = { silent: true, partialResultToken, ...this.options };
            const params = { command: VERIFY, arguments: [system, names, options] };
            return (await client.sendRequest(ExecuteCommandRequest.type, params, token)) as Verification | null;
        } finally {
            parts.dispose();
        }
    }

    private show(
        run: vscode.TestRun,
        item: vscode.TestItem,
        asked: Asked,
        result: Verified,
        stuckness?: Verification["stuck"],
    ): void {
        const outcome = outcomeOf(result, stuckness);
        if (outcome.kind === "errored") {
            const message = new vscode.TestMessage(outcome.message);
            if (result.error) run.errored(item, this.wrong(result.error));
            else run.errored(item, message);
            return;
        }
        done("verified");
        this.judged.set(item.id, expectedOf(result));
        const { short, stuck } = outcome;
        const brief = stuck === undefined ? short : `${short}, ${vscode.l10n.t("gets stuck")}`;
        item.description = brief;
        const line = `${asked.property}: ${brief}`;
        const sentence = result.comment === undefined ? "" : `${result.comment}\r\n`;
        const more = stuck === undefined ? "" : `${stuck.replaceAll(/\r?\n/g, "\r\n")}\r\n`;
        if (stuck !== undefined) this.tellStuck(run, asked.system);
        const warned = outcome.warning === undefined ? "" : `${outcome.warning}\r\n`;
        if (outcome.kind === "unjudged") {
            item.description = `${brief}, ${vscode.l10n.t("no expectation set")}`;
            run.appendOutput(`${sentence}${asked.property}: ${item.description}\r\n${warned}${more}`, undefined, item);
            run.skipped(item);
            return;
        }
        if (outcome.kind === "passed") {
            // The Test Explorer distinguishes only passed and failed, so the description beside the name contains the
            // details.
            if (outcome.uniform.length > 0) {
                const expected = outcome.uniform.join(", ");
                item.description = `${brief}, ${vscode.l10n.t("{0} met under uniform choices", expected)}`;
            }
            if (outcome.unanimous > 0) {
                const said = vscode.l10n.t("no trace of {0} contradicts it", outcome.unanimous.toLocaleString("en"));
                item.description = `${item.description}, ${said}`;
            }
            run.appendOutput(`${sentence}${asked.property}: ${item.description}\r\n${warned}${more}`, undefined, item);
            run.passed(item, outcome.milliseconds);
            return;
        }
        const missed = outcome.missed.length > 0 ? [vscode.l10n.t("expected {0}", outcome.missed.join(", "))] : [];
        run.appendOutput(`${sentence}${[line, ...missed].join(", ")}\r\n${warned}${more}`, undefined, item);
        const text = new vscode.MarkdownString(escaped([brief, ...missed].join(", ")));
        if (result.comment !== undefined) text.appendMarkdown(`\n\n${escaped(result.comment)}`);
        if (stuck !== undefined) text.appendCodeblock(stuck, "text");
        const links: string[] = [];
        if (outcome.hasCounterexample || stuck !== undefined) {
            const property = outcome.hasCounterexample ? asked.property : STUCK;
            links.push(linkTo(SHOW_COUNTEREXAMPLE, vscode.l10n.t("Show Counterexample"), asked.system, property));
        }
        if (result.witness === true)
            links.push(linkTo(SHOW_WITNESS, vscode.l10n.t("Show Witness"), asked.system, asked.property));
        if (links.length > 0) {
            text.appendMarkdown(`\n\n${links.join(" · ")}`);
            text.isTrusted = { enabledCommands: [SHOW_COUNTEREXAMPLE, SHOW_WITNESS] };
        }
        // The message has no location, because the lens and the inlay hint show the same text on that line.
        run.failed(item, new vscode.TestMessage(text), outcome.milliseconds);
    }

    /** Warn once in each run that a system gets stuck: its results are then doubtful, which a passed test does not show. */
    private tellStuck(run: vscode.TestRun, system: string): void {
        const told = this.toldStuck.get(run) ?? new Set<string>();
        this.toldStuck.set(run, told);
        if (told.has(system)) return;
        told.add(system);
        const name = vscode.workspace.asRelativePath(this.uri(system));
        const text = vscode.l10n.t(
            "{0} gets stuck: its time does not advance, because its automata wait for one another.",
            name,
        );
        const show = vscode.l10n.t("Show Waiting Automata");
        void vscode.window.showWarningMessage(text, show).then((pressed) => {
            if (pressed === show) void vscode.commands.executeCommand(SHOW_COUNTEREXAMPLE, system, STUCK);
        });
    }

    private wrong({ message, uri, range }: Wrong): vscode.TestMessage {
        const made = new vscode.TestMessage(message);
        if (uri !== undefined && range) made.location = new vscode.Location(this.uri(uri), rangeOf(range));
        return made;
    }
}

/** A text with a mark at its end, or without it. */
function marked(text: string, mark: string, isMarked: boolean): string {
    const end = `, ${mark}`;
    const plain = text.endsWith(end) ? text.slice(0, -end.length) : text;
    return isMarked ? plain + end : plain;
}

function testId(system: string, property: string): string {
    return `${system}#${property}`;
}

function rangeOf({ start, end }: Property["range"]): vscode.Range {
    return new vscode.Range(start.line, start.character, end.line, end.character);
}

/** The expectations of a result, as a key. */
function expectedOf({ expectations = [] }: Verified): string {
    return JSON.stringify(expectations.map(({ expected, met }) => [expected, met]));
}

/** A link in Markdown that calls a command for a property. */
function linkTo(command: string, title: string, system: string, property: string): string {
    return `[${title}](command:${command}?${encodeURIComponent(JSON.stringify([system, property]))})`;
}

/** Escape the brackets of an interval, which are markup in Markdown. */
function escaped(text: string): string {
    return text.replaceAll(/[\\`*_{}[\]()#+\-.!<>|]/g, "\\$&");
}

/** Expand a system in the Test Explorer, so that the results of its properties are visible. */
async function reveal(suite: vscode.TestItem): Promise<void> {
    const [first] = [...suite.children];
    if (first) await vscode.commands.executeCommand("vscode.revealTestInExplorer", first[1]);
}
