// SPDX-License-Identifier: Apache-2.0
import * as fs from "node:fs";
import * as path from "node:path";
import { ROOT } from "./support/paths";
import type { Stage } from "./support/stage";
import { themes } from "./support/themes";
import type { Window } from "./support/window";
import { temporaryFolder, write } from "./support/workbench";

const EXAMPLE = path.join(ROOT, "examples/fetch_tree");
/** The trees of Nav2, which may be in a folder beside the project. */
const NAV2 = ["../../shared", "../shared"]
    .map((shared) => path.resolve(ROOT, shared, "conformance/trees/nav2"))
    .find((folder) => fs.existsSync(folder));

/** Trees without mocks, side by side as in the folder of Nav2: its own if they are at hand, and that of an example. */
function trees(): string {
    const folder = temporaryFolder("trees");
    const nav2 = NAV2 === undefined ? [] : fs.readdirSync(NAV2).map((name) => path.join(NAV2, name));
    if (NAV2 === undefined) console.log("The trees of Nav2 are not at hand: only the tree of an example is tested.");
    for (const source of [path.join(EXAMPLE, "fetch.xml"), ...nav2.filter((file) => file.endsWith(".xml"))])
        fs.copyFileSync(source, path.join(folder, path.basename(source)));
    // Exploring many states takes minutes here, because the tests compile the kernel without optimization.
    const settings = { "as2fm.verify.exactIfSmall": false, "as2fm.verify.epsilon": 0.1 };
    write(path.join(folder, ".vscode/settings.json"), JSON.stringify(settings));
    return folder;
}

/** Those files that contain a tree, and not only models of nodes. */
function treesIn(folder: string): string[] {
    const hasTree = (name: string) => fs.readFileSync(path.join(folder, name), "utf8").includes("<BehaviorTree ");
    return fs.readdirSync(folder).filter((name) => name.endsWith(".xml") && hasTree(name));
}

function mocksOf(window: Window, tree: string): string {
    return path.join(window.folder, tree.replace(/xml$/, "mocks"));
}

export function loneTrees(stage: Stage): void {
    stage.use();

    stage.test("trees alone are verified with one click each and debugged with F5", trees, async (window) => {
        const { page } = window;
        for (const tree of treesIn(window.folder)) {
            await window.closeAll(); // the lenses of the tree before, which are visible until those of this one come
            await window.openFile(tree);
            await window.running();
            const lens = (text: string | RegExp) => page.locator(".codelens-decoration a", { hasText: text }).first();
            await lens(/^Run$/).waitFor();
            // A second click would begin again.
            const begun = lens(/^Verify · /).or(window.statusItem("Verifying"));
            await window.repeat(() => lens(/^Verify$/).click(), begun);
            await lens(/^Verify · /).waitFor();
            await window.until(() => Promise.resolve(fs.existsSync(mocksOf(window, tree))));
            await page.keyboard.press("F5");
            await page.locator(".debug-toolbar").waitFor();
            await page
                .getByText(/step \d+, /)
                .first()
                .waitFor();
            await page.keyboard.press("Shift+F5");
            await page.locator(".debug-toolbar").waitFor({ state: "hidden" });
        }
        await window.screenshot("trees-verified");
    });

    const example = (theme = "Default Light Modern") => {
        const folder = temporaryFolder("tree");
        fs.copyFileSync(path.join(EXAMPLE, "fetch.xml"), path.join(folder, "fetch.xml"));
        write(path.join(folder, ".vscode/settings.json"), JSON.stringify({ "workbench.colorTheme": theme }));
        return folder;
    };
    for (const [look, theme] of themes("hc-dark", "light", "dark", "hc-light", "hc-dark")) {
        const themed = () => example(theme);
        stage.test(`mocks are edited beside the picture, and verified again, ${look}`, themed, async (window) => {
            const { page } = window;
            await window.openFile("fetch.xml");
            await window.running();
            const lens = page.locator(".codelens-decoration a", { hasText: /^Mocks$/ }).first();
            await lens.waitFor();
            await window.repeat(() => lens.click(), page.locator(".tab", { hasText: "Behavior Tree" }));
            const view = await window.picture(".mock");
            const row = view.locator(".mock", { hasText: "CloseGripper" });
            await row.getByText("action, proposed:").waitFor();
            // Beside the fields, the panel is too narrow for another drawing.
            await view.getByRole("button", { name: "Outline", pressed: true }).waitFor();
            const result = (text: string | RegExp) => view.locator(".mock-head output", { hasText: text }).waitFor();
            await result("Not verified");
            await window.screenshot(`mocks-proposed-${look}`);
            const probability = row.locator('input[type="number"]').first();
            await probability.fill("0");
            await probability.press("Tab");
            await result("succeeds: 0");
            const kept = () => fs.readFileSync(mocksOf(window, "fetch.xml"), "utf8").includes("CloseGripper: 0 in 1 s");
            await window.until(() => Promise.resolve(kept()));
            await row.locator('input[type="range"]').focus();
            for (let step = 0; step < 3; step++) await page.keyboard.press("ArrowRight");
            await result(/succeeds: 0\.\d/);
            await window.run("View: Focus Problems");
            await page.locator(".panel .composite-bar .action-label", { hasText: "Properties" }).click();
            const sentence = page.locator(".panel .monaco-list-row", { hasText: "The tree returns SUCCESS." });
            await sentence.filter({ hasText: /0\.\d+, exact, no expectation set · succeeds/ }).waitFor();
            await sentence.click();
            await page.keyboard.press("ArrowRight");
            await page.locator(".panel .monaco-list-row", { hasText: "no expectation set" }).last().waitFor();
            await window.screenshot(`tree-${look}`, { x: 348, y: 35, width: 932, height: 703 });
        });
    }

    const broken = () => {
        const folder = example();
        fs.writeFileSync(path.join(folder, "fetch.mocks"), "CloseGripper: 7\n");
        return folder;
    };
    stage.test("F5 that cannot start a run says why, without a dialog", broken, async (window) => {
        await window.openFile("fetch.xml");
        await window.running();
        await window.page.keyboard.press("F5");
        await window.notified("is not a probability from 0 to 1");
        await window.page.locator(".monaco-dialog-box").waitFor({ state: "detached" });
    });
}
