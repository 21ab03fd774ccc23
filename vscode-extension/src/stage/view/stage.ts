// SPDX-License-Identifier: Apache-2.0
/** The page of the stage, which shows one run or two. */

import type { FromStage, ToStage } from "../contract";
import { receiveFocus } from "../../pictures/view/focus";
import { ComparedStages } from "./comparedStages";
import { StageView } from "./stageView";

declare function acquireVsCodeApi(): { postMessage(message: FromStage): void };

const editor = acquireVsCodeApi();
const post = (message: FromStage) => {
    editor.postMessage(message);
};
let view: StageView | ComparedStages | undefined;
window.addEventListener("message", ({ data }: MessageEvent<ToStage>) => {
    // What the extension has sent before these messages, it sends once more after them.
    if (data.to === "compare") view ??= new ComparedStages(document.body, post, data.comparison);
    else if (data.to === "words") view ??= new StageView(document.body, post);
    view?.receive(data);
});
receiveFocus(() => view?.focusable);
post({ from: "ready" });
