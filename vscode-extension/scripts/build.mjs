// SPDX-License-Identifier: Apache-2.0
// Bundles the extension and its view into dist/, with the files of the repository that they contain.
import * as fs from "node:fs";
import * as path from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const here = fileURLToPath(new URL("..", import.meta.url));
const root = path.join(here, "..");
const dist = path.join(here, "dist");
const production = process.argv.includes("--production");

for (const name of fs.existsSync(dist) ? fs.readdirSync(dist) : []) {
    if (name !== "wheel" && name !== "packages") fs.rmSync(path.join(dist, name), { recursive: true });
}
const common = { absWorkingDir: here, bundle: true, minify: production, sourcemap: false, logLevel: "warning" };
await esbuild.build({
    ...common,
    entryPoints: ["src/extension.ts"],
    outfile: "dist/extension.js",
    platform: "node",
    format: "cjs",
    target: "node18",
    external: ["vscode"],
    mainFields: ["module", "main"],
});
await esbuild.build({
    ...common,
    entryPoints: [
        "src/pictures/view/view.ts",
        "src/timeline/view/timeline.ts",
        "src/stage/view/stage.ts",
        "src/experiment/view/experiment.ts",
    ],
    outdir: "dist",
    entryNames: "[name]",
    platform: "browser",
    format: "iife",
    target: "es2022",
});
fs.copyFileSync(path.join(here, "src/timeline/view/timeline.css"), path.join(dist, "timeline.css"));
fs.copyFileSync(path.join(here, "src/experiment/view/experiment.css"), path.join(dist, "experiment.css"));
fs.copyFileSync(path.join(root, "server/roaml/figures/plot.css"), path.join(dist, "plot.css"));
fs.copyFileSync(path.join(here, "src/stage/view/stage.css"), path.join(dist, "stage.css"));
// Pictures have the same style in the editor and in the files that the command line writes.
const styles = [
    path.join(root, "server/roaml/figures/figure.css"),
    path.join(root, "server/roaml/figures/timeline.css"),
    path.join(here, "src/pictures/view/view.css"),
];
fs.writeFileSync(path.join(dist, "view.css"), styles.map((file) => fs.readFileSync(file, "utf8")).join(""));

// The schemas, with a catalog that maps their names for the XML extension.
fs.cpSync(path.join(root, "schemas"), path.join(dist, "schemas"), {
    recursive: true,
    filter: (file) => !file.endsWith(".json"),
});
const names = fs.readdirSync(path.join(dist, "schemas")).sort();
const entries = names.map((name) => `  <systemSuffix systemIdSuffix="${name}" uri="${name}"/>`);
fs.writeFileSync(
    path.join(dist, "schemas", "catalog.xml"),
    [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<catalog xmlns="urn:oasis:names:tc:entity:xmlns:xml:catalog">',
        ...entries,
        "</catalog>",
        "",
    ].join("\n"),
);

fs.copyFileSync(path.join(here, "requirements.txt"), path.join(dist, "requirements.txt"));
fs.cpSync(path.join(here, "templates"), path.join(dist, "templates"), { recursive: true });
fs.cpSync(path.join(root, "docs/ci"), path.join(dist, "ci"), { recursive: true });

// The sample of the walkthrough is the system that `init` writes, with one error in it.
const sample = path.join(dist, "sample");
fs.cpSync(path.join(root, "server/as2fm_lsp/templates/delivery_robot"), sample, { recursive: true });
const mistaken = path.join(sample, "nodes/battery.ascxml");
const text = fs.readFileSync(mistaken, "utf8");
const changed = text.replace('location="level" expr="capacity"', 'location="levle" expr="capacity"');
if (changed === text) throw new Error("the mistake of the sample finds no place");
fs.writeFileSync(mistaken, changed);
