// SPDX-License-Identifier: Apache-2.0
// Takes the pictures of `pictures.py` in Chromium, in all four themes: those of panels in the page of the extension, with
// the colors of the themes of VS Code 1.100, and those of files as a browser shows them.
import * as fs from "node:fs";
import { createRequire } from "node:module";
import * as path from "node:path";
import { text } from "node:stream/consumers";
import { fileURLToPath, pathToFileURL } from "node:url";

const extension = fileURLToPath(new URL("../../vscode-extension/", import.meta.url));
const { chromium } = createRequire(path.join(extension, "package.json"))("playwright-core");
const folder = process.argv[2];
const SIZE = { width: 1200, height: 800 };
const COLORS = {
    light: {
        class: "vscode-light",
        "inputOption-activeBackground": "#bed6ed",
        "inputOption-activeBorder": "#005fb8",
        "inputOption-activeForeground": "#000000",
        "editor-background": "#ffffff",
        "editor-foreground": "#3b3b3b",
        descriptionForeground: "#3b3b3b",
        "editorWidget-background": "#f8f8f8",
        "widget-border": "#e5e5e5",
        focusBorder: "#005fb8",
        "charts-green": "#388a34",
        "charts-blue": "#1a85ff",
        "charts-purple": "#652d90",
        "charts-orange": "#d18616",
        "charts-yellow": "#bf8803",
        "charts-red": "#e51400",
        "button-background": "#005fb8",
        "button-foreground": "#ffffff",
        "button-hoverBackground": "#0258a8",
        "button-secondaryBackground": "#e5e5e5",
        "button-secondaryForeground": "#3b3b3b",
        "input-background": "#ffffff",
        "input-foreground": "#3b3b3b",
        "input-border": "#cecece",
    },
    dark: {
        class: "vscode-dark",
        "inputOption-activeBackground": "rgba(36, 137, 219, 0.51)",
        "inputOption-activeBorder": "#2488db",
        "inputOption-activeForeground": "#ffffff",
        "editor-background": "#1f1f1f",
        "editor-foreground": "#cccccc",
        descriptionForeground: "#9d9d9d",
        "editorWidget-background": "#202020",
        "widget-border": "#313131",
        focusBorder: "#0078d4",
        "charts-green": "#89d185",
        "charts-blue": "#3794ff",
        "charts-purple": "#b180d7",
        "charts-orange": "#d18616",
        "charts-yellow": "#cca700",
        "charts-red": "#f14c4c",
        "button-background": "#0078d4",
        "button-foreground": "#ffffff",
        "button-hoverBackground": "#026ec1",
        "button-secondaryBackground": "#313131",
        "button-secondaryForeground": "#cccccc",
        "input-background": "#313131",
        "input-foreground": "#cccccc",
        "input-border": "#3c3c3c",
    },
    "high-contrast": {
        class: "vscode-high-contrast",
        "inputOption-activeBackground": "rgba(0, 0, 0, 0)",
        "inputOption-activeBorder": "#6fc3df",
        "inputOption-activeForeground": "#ffffff",
        "editor-background": "#000000",
        "editor-foreground": "#ffffff",
        descriptionForeground: "rgba(255, 255, 255, 0.7)",
        "editorWidget-background": "#0c141f",
        "widget-border": "#6fc3df",
        contrastBorder: "#6fc3df",
        contrastActiveBorder: "#f38518",
        focusBorder: "#f38518",
        "button-foreground": "#ffffff",
        "button-secondaryForeground": "#ffffff",
        "button-border": "#6fc3df",
        "input-background": "#000000",
        "input-foreground": "#ffffff",
        "input-border": "#6fc3df",
    },
    "high-contrast-light": {
        class: "vscode-high-contrast-light vscode-high-contrast",
        "inputOption-activeBackground": "rgba(0, 0, 0, 0)",
        "inputOption-activeBorder": "#0f4a85",
        "inputOption-activeForeground": "#292929",
        "editor-background": "#ffffff",
        "editor-foreground": "#292929",
        descriptionForeground: "rgba(41, 41, 41, 0.7)",
        "editorWidget-background": "#ffffff",
        "widget-border": "#0f4a85",
        contrastBorder: "#0f4a85",
        contrastActiveBorder: "#006bbd",
        focusBorder: "#006bbd",
        "button-background": "#0f4a85",
        "button-foreground": "#ffffff",
        "button-hoverBackground": "#0f4a85",
        "button-secondaryBackground": "#ffffff",
        "button-secondaryForeground": "#292929",
        "button-border": "#0f4a85",
        "input-background": "#ffffff",
        "input-foreground": "#292929",
        "input-border": "#0f4a85",
    },
};
const KINDS = {
    variable: "blackboard",
    "action-interface": "ROS action",
    eventless: "without event",
    ros: "ROS",
    bt: "behavior tree",
};
const NAMED = {
    onlyResults: "Only Results",
    showAll: "Show All",
    outline: "Outline",
    search: "Search",
    zoomIn: "Zoom in",
};
const CAPTIONS = {
    zoomOut: "Zoom out",
    fit: "Fit",
    saveSvg: "Save as SVG",
    savePng: "Save as PNG",
    savePdf: "Save as PDF",
};
const OTHERS = {
    nothing: "No results",
    help: "",
    byChance: "random",
    mock: "mock: probability of success, duration",
    initial: "initial state",
    final: "state without a way out",
    looks: {},
    mocks: "Mocks",
    verify: "Verify",
    outlineHint: "",
};
const COVERAGE = { show: "Coverage", hint: "" };

function page(theme) {
    const { class: name, ...colors } = COLORS[theme];
    const variables = Object.entries(colors).map(([key, value]) => `--vscode-${key}: ${value};`);
    const font = "--vscode-font-family: system-ui, Ubuntu, 'Droid Sans', sans-serif;";
    const css = fs.readFileSync(path.join(extension, "dist/view.css"), "utf8");
    const script = fs.readFileSync(path.join(extension, "dist/view.js"), "utf8");
    return `<!DOCTYPE html><html lang="en" style="${variables.join(" ")} ${font}"><head><meta charset="utf-8">
<style>${css}</style></head><body class="${name}"><script>
window.sent = []; window.acquireVsCodeApi = () => ({ postMessage: (message) => window.sent.push(message.type) });
</script><script>${script}</script></body></html>`;
}

/** What is wrong with the chips of a picture that a page shows: each leader begins at the line that it continues, and its
 * chip names the other end of the line. */
function wrongLeaders({ nodes, edges }) {
    const labels = new Map(nodes.map(({ id, label }) => [id, label]));
    const HEAD = 12;
    return [...document.querySelectorAll(".leaders > [data-exit]")].flatMap(({ dataset, firstElementChild: leader }) => {
        const edge = edges[Number(dataset.exit)];
        const names = dataset.chip.split("\n");
        const isNamed = [edge.source, edge.target].some((id) => names.includes(labels.get(id)));
        const start = leader.getPointAtLength(0).matrixTransform(leader.getScreenCTM());
        const links = document.querySelectorAll(`.scene > :is(.link, .edge)[data-edges~="${dataset.exit}"] > .line`);
        const isAtLine = [...links].some((line) => {
            const { left, right, top, bottom } = line.getBoundingClientRect();
            // The head of an arrow is between the end of its line and a node just behind the border.
            const isNear = (at, low, high) => at > low - HEAD && at < high + HEAD;
            return isNear(start.x, left, right) && isNear(start.y, top, bottom);
        });
        return isNamed && isAtLine ? [] : [`${edge.source} → ${edge.target}: ${dataset.chip}`];
    });
}

const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] });
const jobs = JSON.parse(await text(process.stdin));
for (const theme of Object.keys(COLORS)) {
    const colorScheme = theme === "dark" || theme === "high-contrast" ? "dark" : "light";
    const contrast = theme.startsWith("high-contrast") ? "more" : "no-preference";
    const context = await browser.newContext({ viewport: SIZE, colorScheme, contrast, reducedMotion: "reduce" });
    const background = COLORS[theme]["editor-background"];
    const file = path.join(folder, `page.${theme}.html`);
    fs.writeFileSync(file, page(theme));
    for (const { name, picture, files } of jobs) {
        const tab = await context.newPage();
        if (picture) {
            await tab.goto(pathToFileURL(path.resolve(file)).href);
            const kinds = Object.fromEntries(
                [...picture.nodes, ...picture.edges].map(({ kind }) => [kind, KINDS[kind] ?? kind]),
            );
            for (const { interface: kind } of picture.edges) if (kind) kinds[kind] = KINDS[kind] ?? kind;
            const words = { ...NAMED, ...CAPTIONS, ...OTHERS, coverage: COVERAGE, kinds };
            const part = { matching: "", around: "" };
            await tab.evaluate(
                ([words, show]) => {
                    window.postMessage({ type: "words", words });
                    window.postMessage(show);
                },
                [words, { type: "show", picture, part, here: null, highlighted: "" }],
            );
            await tab.waitForFunction(() => window.sent.includes("drawn"));
        } else if (files[theme].endsWith(".svg")) {
            // As a viewer of pictures shows it: as a whole.
            const image = `<img src="data:image/svg+xml;base64,${fs.readFileSync(files[theme]).toString("base64")}"`;
            const body = `<body style="margin:0;display:grid;place-items:center;height:100vh;background:${background}">`;
            await tab.setContent(`${body}${image} style="max-width:100vw;max-height:100vh"></body>`);
        } else {
            await tab.goto(pathToFileURL(files[theme]).href);
        }
        // The second frame contains what the first one has laid out.
        await tab.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
        const wrong = picture ? await tab.evaluate(wrongLeaders, { nodes: picture.nodes, edges: picture.edges }) : [];
        if (wrong.length > 0) throw new Error(`${name}: chips that do not belong to their lines: ${wrong.join("; ")}`);
        await tab.screenshot({ path: path.join(folder, `${name}.${theme}.png`) });
        await tab.close();
    }
    fs.rmSync(file);
    await context.close();
}
await browser.close();
