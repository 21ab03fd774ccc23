// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { PrivateEnvironment, type Step } from "../src/server/environment";
import type { Ended } from "../src/server/run";
import { FakeHost, python } from "./support/host";

const HOME = "/storage/2";
const INSIDE = `${HOME}/bin/python`;

interface Answers {
    readonly venv?: Partial<Ended>;
    readonly pip?: Partial<Ended>;
    readonly version?: Partial<Ended>;
}

function host({ venv = {}, pip = {}, version = { out: "as2fm-lsp 0.1.0" } }: Answers = {}): FakeHost {
    return new FakeHost({
        "/bin/python3": (args) => (args.includes("venv") ? venv : python("/bin/python3")(args)),
        [INSIDE]: (args) => (args.includes("pip") ? pip : version),
    });
}

function install(on: FakeHost, preferred: string[] = [], onStep: (step: Step) => void = () => undefined) {
    return new PrivateEnvironment(on, "/storage", "/server.whl", "/requirements.txt", "2").install(preferred, {
        onStep,
    });
}

test("an environment is created, the wheel installed and the mark written last", async () => {
    const on = host();
    on.files.set("/storage/1/ready.json", "{}");
    const steps: Step[] = [];
    const found = await install(on, [], (step) => steps.push(step));
    assert.ok("origin" in found && found.origin === "private" && found.version === "0.1.0");
    assert.deepEqual(steps, ["python", "venv", "packages"]);
    assert.ok(on.ran.includes(`/bin/python3 -I -m venv ${HOME}`));
    const pip = `${INSIDE} -I -m pip install --disable-pip-version-check --no-input`;
    assert.deepEqual(
        on.ran.filter((line) => line.includes("pip")),
        [
            // Packages are installed only by their hashes, and without code that builds them. The wheel is local.
            `${pip} --require-hashes --only-binary :all: -r /requirements.txt`,
            `${pip} --no-index --no-deps /server.whl`,
        ],
    );
    // The environment of the earlier version was removed.
    assert.deepEqual([...on.files.keys()], [`${HOME}/ready.json`]);
});

test("the packages in an extension for one platform are used before the index", async () => {
    const local = "--no-index --find-links /packages";
    const packages = "--require-hashes --only-binary :all: -r /requirements.txt";
    const server = `${local} --find-links / --no-deps as2fm-lsp`;
    const pip = `${INSIDE} -I -m pip install --disable-pip-version-check --no-input`;
    for (const isComplete of [true, false]) {
        const on = new FakeHost({
            "/bin/python3": (args) => (args.includes("venv") ? {} : python("/bin/python3")(args)),
            [INSIDE]: (args) => {
                if (!args.includes("pip")) return { out: "as2fm-lsp 0.1.0" };
                return { status: args.includes("--no-index") && args.includes("-r") && !isComplete ? 1 : 0 };
            },
        });
        on.files.set("/packages/lxml-1-cp310-cp310-linux_x86_64.whl", "");
        const found = await install(on);
        assert.ok("origin" in found);
        const fromIndex = isComplete ? [] : [`${pip} ${packages}`];
        assert.deepEqual(
            on.ran.filter((line) => line.includes("pip")),
            [`${pip} ${local} ${packages}`, ...fromIndex, `${pip} ${server}`],
        );
    }
});

/** An environment that has been created, in which the attempt to compile has this result. */
function made(ended: Partial<Ended>): { on: FakeHost; environment: PrivateEnvironment } {
    const on = new FakeHost({ [INSIDE]: () => ended });
    on.files.set(`${HOME}/ready.json`, '{"version": "0.1.0"}');
    return { on, environment: new PrivateEnvironment(on, "/storage", "/server.whl", "/requirements.txt", "2") };
}

const COMPILE = `${INSIDE} -I -m as2fm_lsp.cli.build_kernel`;

test("the kernel is compiled in the environment, once", async () => {
    const { on, environment } = made({ status: 0, out: "the kernel was compiled" });
    let output = "";
    for (let start = 0; start < 2; start++) await environment.compile((text) => (output += text));
    assert.deepEqual(on.ran, [COMPILE]);
    assert.equal(output, "the kernel was compiled");
});

test("without a C compiler it is tried once", async () => {
    const { on, environment } = made({ status: 1, err: "there is no C compiler" });
    for (let start = 0; start < 2; start++) await environment.compile(() => undefined);
    assert.deepEqual(on.ran, [COMPILE]);
});

test("an attempt that was interrupted is repeated at the next start", async () => {
    for (const status of [2, null]) {
        const { on, environment } = made({ status });
        for (let start = 0; start < 2; start++) await environment.compile(() => undefined);
        assert.deepEqual(on.ran, [COMPILE, COMPILE]);
    }
});

test("nothing is compiled without an environment", async () => {
    const on = host();
    await new PrivateEnvironment(on, "/storage", "/server.whl", "/requirements.txt", "2").compile(() => undefined);
    assert.deepEqual(on.ran, []);
});

test("the preferred interpreter comes first", async () => {
    const on = new FakeHost({
        "/bin/python3": python("/bin/python3"),
        "/conda/python": (args) => (args.includes("venv") ? {} : python("/conda/python", "3.13")(args)),
        [INSIDE]: () => ({ out: "as2fm-lsp 0.1.0" }),
    });
    await install(on, ["/conda/python"]);
    assert.ok(on.ran.includes(`/conda/python -I -m venv ${HOME}`));
});

test("no Python of an untrusted folder is started", async () => {
    const on = host();
    const environment = new PrivateEnvironment(on, "/storage", "/server.whl", "/requirements.txt", "2");
    assert.deepEqual(await environment.install(["/bin/python3"], { avoid: ["/bin"] }), { kind: "no-python" });
    assert.deepEqual(on.ran, []);
});

test("no Python, or an old one only", async () => {
    assert.deepEqual(await install(new FakeHost({})), { kind: "no-python" });
    const old = new FakeHost({ "/bin/python3": python("/bin/python3", "3.9") });
    assert.deepEqual(await install(old), { kind: "no-python" });
});

test("a Python without venv", async () => {
    const on = host({ venv: { status: 1, out: "ensurepip is not available" } });
    const found = await install(on);
    assert.deepEqual(found, { kind: "no-venv", python: "3.11", detail: "ensurepip is not available" });
    assert.equal(on.files.size, 0);
});

test("another Python is tried if one lacks venv", async () => {
    const on = new FakeHost({
        "/bin/python3": (args) => (args.includes("venv") ? { status: 1 } : python("/bin/python3")(args)),
        "/bin/python3.12": (args) => (args.includes("venv") ? {} : python("/bin/python3.12", "3.12")(args)),
        [INSIDE]: () => ({ out: "as2fm-lsp 0.1.0" }),
    });
    assert.ok("origin" in (await install(on)));
});

test("no package index: the end of the output of pip is reported, no files are left", async () => {
    const said = [...Array.from({ length: 20 }, (_, i) => `line ${i}`), "ERROR: No matching distribution"].join("\n");
    const found = await install(host({ pip: { status: 1, err: said } }));
    assert.ok("kind" in found && found.kind === "no-packages");
    assert.equal(found.detail.split("\n").length, 8);
    assert.match(found.detail, /No matching distribution$/);
});

test("an environment that does not work is not kept", async () => {
    const on = host({ version: { status: 1, err: "No module named as2fm_lsp" } });
    const found = await install(on);
    assert.ok("kind" in found && found.kind === "no-packages");
    assert.equal(
        await new PrivateEnvironment(on, "/storage", "/server.whl", "/requirements.txt", "2").server(),
        undefined,
    );
});

test("the environment of an earlier version is known, and stays until the new one is there", async () => {
    const on = host({ pip: { status: 1 } });
    on.files.set("/storage/1/ready.json", JSON.stringify({ version: "0.0.9" }));
    const environment = new PrivateEnvironment(on, "/storage", "/server.whl", "/requirements.txt", "2");
    assert.equal(await environment.server(), undefined);
    await environment.install([]);
    const older = await environment.older();
    assert.deepEqual([older?.command, older?.version], ["/storage/1/bin/python", "0.0.9"]);
    assert.equal(
        await new PrivateEnvironment(on, "/storage", "/server.whl", "/requirements.txt", "1").older(),
        undefined,
    );
});
