// SPDX-License-Identifier: Apache-2.0
// Renders icons/as2fm.svg as PNG, which marketplaces require.
import * as fs from "node:fs";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const icons = fileURLToPath(new URL("../icons/", import.meta.url));
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 256, height: 256 } });
await page.setContent(
    `<style>*{margin:0}svg{display:block;width:256px}</style>${fs.readFileSync(`${icons}as2fm.svg`, "utf8")}`,
);
await page.screenshot({ path: `${icons}as2fm.png`, omitBackground: true });
await browser.close();
