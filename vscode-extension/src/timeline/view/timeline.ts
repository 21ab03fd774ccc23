// SPDX-License-Identifier: Apache-2.0
/** The page of the view of the timeline. */

import type { FromTimeline, ToTimeline } from "../contract";
import { receiveFocus } from "../../pictures/view/focus";
import { TimelineView } from "./timelineView";

declare function acquireVsCodeApi(): { postMessage(message: FromTimeline): void };

const editor = acquireVsCodeApi();
const view = new TimelineView(document.body, (message) => {
    editor.postMessage(message);
});
window.addEventListener("message", ({ data }: MessageEvent<ToTimeline>) => {
    view.receive(data);
});
receiveFocus(() => view.focusable);
editor.postMessage({ type: "ready" });
