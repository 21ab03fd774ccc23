// SPDX-License-Identifier: Apache-2.0
/** The page of the stage. */

import type { FromStage, ToStage } from "../contract";
import { StageView } from "./stageView";

declare function acquireVsCodeApi(): { postMessage(message: FromStage): void };

const editor = acquireVsCodeApi();
const view = new StageView(document.body, (message) => {
    editor.postMessage(message);
});
window.addEventListener("message", ({ data }: MessageEvent<ToStage>) => {
    view.receive(data);
});
editor.postMessage({ from: "ready" });
