// SPDX-License-Identifier: Apache-2.0
/** The page of a panel with one picture. */

import type { FromView, ToView } from "../contract";
import { receiveFocus } from "./focus";
import { PictureView } from "./pictureView";

declare function acquireVsCodeApi(): { postMessage(message: FromView): void };

const editor = acquireVsCodeApi();
const view = new PictureView(document.body, (message) => {
    editor.postMessage(message);
});
window.addEventListener("message", ({ data }: MessageEvent<ToView>) => {
    view.receive(data);
});
receiveFocus(() => view.focusable);
editor.postMessage({ type: "ready" });
