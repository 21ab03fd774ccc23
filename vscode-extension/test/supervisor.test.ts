// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Failure, Server } from "../src/server/server";
import { CRASH_WINDOW, MAX_CRASHES, Supervisor, type Exit, type Ports, type Session } from "../src/server/supervisor";

const SERVER: Server = { origin: "path", command: "as2fm-lsp", args: [], version: "0.1.0" };
const KILLED: Exit = { status: null, signal: "SIGKILL", detail: "last words" };

class Fake implements Ports {
    readonly states: string[] = [];
    readonly restarts: Exit[] = [];
    readonly sessions: { end(exit: Exit): void; stopped: boolean }[] = [];
    readonly launched: Server[] = [];
    found: Server | Failure = SERVER;
    launching: () => Promise<void> = () => Promise.resolve();
    time = 0;

    find(): Promise<Server | Failure> {
        return Promise.resolve(this.found);
    }
    install(onStep: (step: "venv") => void): Promise<Server | Failure> {
        onStep("venv");
        return Promise.resolve(this.found);
    }
    async launch(server: Server): Promise<Session> {
        this.launched.push(server);
        await this.launching();
        let end: (exit: Exit) => void = () => undefined;
        const ended = new Promise<Exit>((resolve) => (end = resolve));
        const session = { end, stopped: false };
        this.sessions.push(session);
        return {
            ended,
            stop: () => {
                session.stopped = true;
                end({ status: 0, signal: null, detail: "" });
                return Promise.resolve();
            },
        };
    }
    now(): number {
        return this.time;
    }
    changed(state: { kind: string; step?: string }): void {
        this.states.push(state.step ? `${state.kind} ${state.step}` : state.kind);
    }
    restarted(exit: Exit): void {
        this.restarts.push(exit);
    }
}

async function crash(fake: Fake): Promise<void> {
    fake.sessions.at(-1)?.end(KILLED);
    await new Promise(setImmediate);
}

test("searching, starting, running, stopped", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    await supervisor.stop();
    assert.deepEqual(fake.states, ["searching", "starting", "running", "stopped"]);
    assert.ok(fake.sessions[0]?.stopped);
    assert.deepEqual(fake.restarts, []);
});

test("a failed search is a state, and an installation ends it", async () => {
    const fake = new Fake();
    fake.found = { kind: "no-server" };
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    assert.deepEqual(supervisor.state, { kind: "failed", failure: { kind: "no-server" } });
    fake.found = SERVER;
    await supervisor.install();
    const after = ["installing python", "installing venv", "starting", "running"];
    assert.deepEqual(fake.states, ["searching", "failed", ...after]);
});

test("a server that does not start, and an internal error", async () => {
    const fake = new Fake();
    fake.launching = () => Promise.reject(new Error("it ended with status 3"));
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    const failure = { kind: "start", server: SERVER, detail: "it ended with status 3" };
    assert.deepEqual(supervisor.state, { kind: "failed", failure });
    fake.find = () => Promise.reject(new Error("oops"));
    await supervisor.start();
    assert.deepEqual(supervisor.state, { kind: "failed", failure: { kind: "internal", detail: "oops" } });
});

test("a server that crashes is restarted and reported", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    await crash(fake);
    assert.equal(fake.sessions.length, 2);
    assert.equal(supervisor.state.kind, "running");
    assert.deepEqual(fake.restarts, [KILLED]);
});

test("a server that crashes repeatedly is not restarted, one that crashes seldom is", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    for (let i = 0; i <= MAX_CRASHES; i++) await crash(fake);
    const count = MAX_CRASHES + 1;
    const failure = { kind: "crashes", server: SERVER, count, detail: "last words" };
    assert.deepEqual(supervisor.state, { kind: "failed", failure });
    await supervisor.start(); // a request of the user resets the count of crashes
    for (let i = 0; i < 3 * MAX_CRASHES; i++) {
        fake.time += CRASH_WINDOW / 2;
        await crash(fake);
    }
    assert.equal(supervisor.state.kind, "running");
});

test("a server that ends during its restart has crashed again", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    let left = 2;
    fake.launching = () => (left-- > 0 ? Promise.reject(new Error("killed")) : Promise.resolve());
    await crash(fake);
    await new Promise(setImmediate);
    assert.equal(supervisor.state.kind, "running");
    assert.deepEqual(fake.restarts, [KILLED]);
    fake.launching = () => Promise.reject(new Error("killed"));
    await crash(fake);
    const failure = { kind: "crashes", server: SERVER, count: MAX_CRASHES + 1, detail: "last words" };
    assert.deepEqual(supervisor.state, { kind: "failed", failure });
});

test("a restart stops the running server and is not a crash", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    await supervisor.start();
    assert.deepEqual(
        fake.sessions.map((session) => session.stopped),
        [true, false],
    );
    assert.deepEqual(fake.restarts, []);
});

const OTHER: Server = { ...SERVER, origin: "python", command: "/env/bin/python" };

test("an expected server is started before the search ends", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.expect(SERVER);
    assert.deepEqual(fake.states, ["starting", "running"]);
    assert.deepEqual(fake.launched, [SERVER]);
});

test("the result of the search replaces the expected server", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.expect(OTHER);
    assert.deepEqual(supervisor.state, { kind: "running", server: SERVER });
    assert.deepEqual(fake.launched, [OTHER, SERVER]);
    assert.deepEqual(
        fake.sessions.map((session) => session.stopped),
        [true, false],
    );
    fake.found = { kind: "no-server" };
    await supervisor.expect(OTHER);
    assert.deepEqual(supervisor.state, { kind: "failed", failure: { kind: "no-server" } });
    assert.ok(fake.sessions.every((session) => session.stopped));
});

test("an expected server that does not start is not a failure", async () => {
    const fake = new Fake();
    let left = 1;
    fake.launching = () => (left-- > 0 ? Promise.reject(new Error("it is gone")) : Promise.resolve());
    const supervisor = new Supervisor(fake);
    await supervisor.expect(OTHER);
    assert.deepEqual(fake.states, ["starting", "searching", "starting", "running"]);
    assert.deepEqual(supervisor.state, { kind: "running", server: SERVER });
});

test("a new search does not restart the same server, and reports failures", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.look();
    await supervisor.look();
    assert.deepEqual(fake.launched, [SERVER]);
    fake.found = { ...SERVER, version: "0.2.0" };
    await supervisor.look();
    assert.deepEqual(fake.launched, [SERVER, fake.found]);
    fake.find = () => Promise.reject(new Error("oops"));
    await supervisor.look();
    assert.deepEqual(supervisor.state, { kind: "failed", failure: { kind: "internal", detail: "oops" } });
});

test("the result of a search after a newer request changes nothing", async () => {
    const fake = new Fake();
    const supervisor = new Supervisor(fake);
    await supervisor.start();
    let find: (found: Server) => void = () => undefined;
    fake.find = () => new Promise((resolve) => (find = resolve));
    const looking = supervisor.look();
    await supervisor.stop();
    find(OTHER);
    await looking;
    assert.equal(supervisor.state.kind, "stopped");
});

test("results of superseded requests change nothing", async () => {
    const fake = new Fake();
    let go: () => void = () => undefined;
    fake.launching = () => new Promise((resolve) => (go = resolve));
    const supervisor = new Supervisor(fake);
    const first = supervisor.start();
    await new Promise(setImmediate);
    const stopped = supervisor.stop();
    go();
    await Promise.all([first, stopped]);
    assert.equal(supervisor.state.kind, "stopped");
    assert.ok(fake.sessions[0]?.stopped);
});
