// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import * as fs from "node:fs";
import * as path from "node:path";
import { after, before, test } from "node:test";
import { Workbench, temporaryFolder, EXTENSION } from "./support/workbench";
import type { Window } from "./support/window";

let workbench: Workbench;
let window: Window;
const folder = temporaryFolder("sample");

before(async () => {
    fs.cpSync(path.join(EXTENSION, "dist/sample"), folder, { recursive: true });
    workbench = await Workbench.start();
    window = await workbench.open(folder);
});

after(async () => {
    await window.screenshot("last");
    await workbench.stop();
});

test("the first start creates the private environment", async () => {
    await window.openFile("battery.ascxml");
    const offer = window.notification("is not installed yet");
    await offer.waitFor();
    await window.screenshot("first-start");
    await offer.getByRole("button", { name: "Install" }).click();
    await window.statusItem("AS2FM: 0.1.0").waitFor({ timeout: 120_000 });
    await window.squiggles.first().waitFor();
    await window.screenshot("planted-mistake");
    assert.equal(await window.squiggles.count(), 1);
});
