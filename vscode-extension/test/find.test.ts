// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { PrivateEnvironment } from "../src/server/environment";
import { expanded, findServer, isRecent, type Wishes } from "../src/server/find";
import { FakeMachine, python, server } from "./support/machine";

const NOTHING: Wishes = { server: "", interpreter: "", active: [], trusted: true };
const MARK = "/storage/1/ready.json";

function find(machine: FakeMachine, wishes: Partial<Wishes> = {}) {
    const environment = new PrivateEnvironment(machine, "/storage", "/server.whl", "/requirements.txt", "1");
    return findServer(machine, { ...NOTHING, ...wishes }, environment);
}

function everything(): FakeMachine {
    const machine = new FakeMachine({
        "/opt/as2fm-lsp": server("0.4.0"),
        "/venv/bin/python": python("/venv/bin/python", "3.12", "0.3.0"),
        "/bin/as2fm-lsp": server("0.2.0"),
    });
    machine.files.set(MARK, JSON.stringify({ version: "0.1.0" }));
    return machine;
}

test("the setting comes first, then Python, PATH and the private environment", async () => {
    const all = { server: "/opt/as2fm-lsp", active: ["/venv/bin/python"] };
    const found = await find(everything(), all);
    assert.deepEqual(found, { origin: "setting", command: "/opt/as2fm-lsp", args: [], version: "0.4.0" });
    assert.deepEqual(await find(everything(), { ...all, server: "" }), {
        origin: "python",
        command: "/venv/bin/python",
        args: ["-I", "-m", "as2fm_lsp"],
        version: "0.3.0",
    });
    const onPath = { origin: "path", command: "/bin/as2fm-lsp", args: [], version: "0.2.0" };
    assert.deepEqual(await find(everything()), onPath);
    const machine = new FakeMachine({});
    machine.files.set(MARK, JSON.stringify({ version: "0.1.0" }));
    assert.deepEqual(await find(machine), {
        origin: "private",
        command: "/storage/1/bin/python",
        args: ["-I", "-m", "as2fm_lsp"],
        version: "0.1.0",
    });
    assert.deepEqual(await find(new FakeMachine({})), { kind: "no-server" });
});

test("a setting that does not work is reported, not skipped", async () => {
    const found = await find(everything(), { server: "/nowhere/as2fm-lsp" });
    const detail = "spawn /nowhere/as2fm-lsp ENOENT";
    assert.deepEqual(found, { kind: "configured-server", path: "/nowhere/as2fm-lsp", detail });
    const other = new FakeMachine({ "/bin/cat": () => ({ out: "cat (GNU coreutils) 9.1" }) });
    const cat = await find(other, { server: "/bin/cat" });
    assert.deepEqual(cat, { kind: "configured-server", path: "/bin/cat", detail: "cat (GNU coreutils) 9.1" });
});

test("without trust nothing is started but the private environment", async () => {
    const machine = everything();
    const wishes = { server: "/opt/as2fm-lsp", interpreter: "/venv/bin/python", active: ["/venv/bin/python"] };
    const found = await find(machine, { ...wishes, trusted: false });
    assert.ok("origin" in found && found.origin === "private");
    machine.files.clear();
    assert.deepEqual(await find(machine, { ...wishes, trusted: false }), { kind: "no-server" });
    assert.deepEqual(machine.ran, []);
});

test("Python never imports modules of the working folder", async () => {
    const machine = everything();
    await find(machine, { active: ["/venv/bin/python", "/none/python"] });
    const python = machine.ran.filter((line) => line.includes("python"));
    assert.ok(python.length > 0);
    for (const line of python) assert.match(line, /python\d*(\.\d+)? -I /);
});

test("an interpreter in the settings is used instead of the active one", async () => {
    const machine = new FakeMachine({
        "/a/python": python("/a/python", "3.10", "0.1.0"),
        "/b/python": python("/b/python", "3.10", "0.1.0"),
    });
    const found = await find(machine, { interpreter: "/a/python", active: ["/b/python"] });
    assert.ok("command" in found && found.command === "/a/python");
});

test("servers that are too old and other programs are skipped", async () => {
    const old = new FakeMachine({
        "/old/python": python("/old/python", "3.8", "0.3.0"),
        "/none/python": python("/none/python", "3.12"),
        "/bin/as2fm-lsp": server("0.0.9"),
    });
    assert.deepEqual(await find(old, { active: ["/old/python", "/none/python", "/no/python"] }), { kind: "no-server" });
    const marked = new FakeMachine({});
    marked.files.set(MARK, "{ half");
    assert.deepEqual(await find(marked), { kind: "no-server" });
});

test("versions", () => {
    assert.ok(isRecent("0.1.0"));
    assert.ok(isRecent("0.10.0", "0.9.5"));
    assert.ok(isRecent("1.0.0rc1", "0.9"));
    assert.ok(!isRecent("0.9.5", "0.10.0"));
    assert.ok(!isRecent("unknown"));
});

test("paths as users write them", () => {
    assert.equal(expanded(" ~/bin/x ", "/home/me", undefined), "/home/me/bin/x");
    assert.equal(expanded("${workspaceFolder}/.venv/bin/python", "/h", "/ws"), "/ws/.venv/bin/python");
    assert.equal(expanded("~me/x", "/h", "/ws"), "~me/x");
    assert.equal(expanded("", "/h", "/ws"), "");
});
