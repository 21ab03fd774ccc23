// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { PrivateEnvironment } from "../src/server/environment";
import { expanded, findServer, isRecent, type ServerSettings } from "../src/server/find";
import { FakeHost, python, server } from "./support/host";

const NOTHING: ServerSettings = { server: "", interpreter: "", active: [], trusted: true };
const MARK = "/storage/1/ready.json";

function find(host: FakeHost, settings: Partial<ServerSettings> = {}) {
    const environment = new PrivateEnvironment(host, "/storage", "/server.whl", "/requirements.txt", "1");
    return findServer(host, { ...NOTHING, ...settings }, environment);
}

function everything(): FakeHost {
    const host = new FakeHost({
        "/opt/as2fm-lsp": server("0.4.0"),
        "/venv/bin/python": python("/venv/bin/python", "3.12", "0.3.0"),
        "/bin/as2fm-lsp": server("0.2.0"),
    });
    host.files.set(MARK, JSON.stringify({ version: "0.1.0" }));
    return host;
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
    const host = new FakeHost({});
    host.files.set(MARK, JSON.stringify({ version: "0.1.0" }));
    assert.deepEqual(await find(host), {
        origin: "private",
        command: "/storage/1/bin/python",
        args: ["-I", "-m", "as2fm_lsp"],
        version: "0.1.0",
    });
    assert.deepEqual(await find(new FakeHost({})), { kind: "no-server" });
});

test("a setting that does not work is reported, not skipped", async () => {
    const found = await find(everything(), { server: "/nowhere/as2fm-lsp" });
    const detail = "spawn /nowhere/as2fm-lsp ENOENT";
    assert.deepEqual(found, { kind: "configured-server", path: "/nowhere/as2fm-lsp", detail });
    const other = new FakeHost({ "/bin/cat": () => ({ out: "cat (GNU coreutils) 9.1" }) });
    const cat = await find(other, { server: "/bin/cat" });
    assert.deepEqual(cat, { kind: "configured-server", path: "/bin/cat", detail: "cat (GNU coreutils) 9.1" });
});

test("without trust nothing is started but the private environment", async () => {
    const host = everything();
    const settings = { server: "/opt/as2fm-lsp", interpreter: "/venv/bin/python", active: ["/venv/bin/python"] };
    const found = await find(host, { ...settings, trusted: false });
    assert.ok("origin" in found && found.origin === "private");
    host.files.clear();
    assert.deepEqual(await find(host, { ...settings, trusted: false }), { kind: "no-server" });
    assert.deepEqual(host.ran, []);
});

test("Python never imports modules of the working folder", async () => {
    const host = everything();
    await find(host, { active: ["/venv/bin/python", "/none/python"] });
    const python = host.ran.filter((line) => line.includes("python"));
    assert.ok(python.length > 0);
    for (const line of python) assert.match(line, /python\d*(\.\d+)? -I /);
});

test("an interpreter in the settings is used instead of the active one", async () => {
    const host = new FakeHost({
        "/a/python": python("/a/python", "3.10", "0.1.0"),
        "/b/python": python("/b/python", "3.10", "0.1.0"),
    });
    const found = await find(host, { interpreter: "/a/python", active: ["/b/python"] });
    assert.ok("command" in found && found.command === "/a/python");
});

test("servers that are too old and other programs are skipped", async () => {
    const old = new FakeHost({
        "/old/python": python("/old/python", "3.8", "0.3.0"),
        "/none/python": python("/none/python", "3.12"),
        "/bin/as2fm-lsp": server("0.0.9"),
    });
    assert.deepEqual(await find(old, { active: ["/old/python", "/none/python", "/no/python"] }), { kind: "no-server" });
    const marked = new FakeHost({});
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
