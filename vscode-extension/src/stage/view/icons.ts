// SPDX-License-Identifier: Apache-2.0
/** The icons of the stage, as paths in a square of 16 pixels. The fonts of a page may lack such signs. */

import { element } from "../../pictures/view/scene";
import type { Move } from "../contract";

const BAR_LEFT = "M 2 3 H 4 V 13 H 2 Z";
const BAR_RIGHT = "M 12 3 H 14 V 13 H 12 Z";

const PATHS: Readonly<Record<Move | "play" | "pause", string>> = {
    toStart: `${BAR_LEFT} M 13 3 V 13 L 5 8 Z`,
    reverse: "M 8 3 V 13 L 1 8 Z M 15 3 V 13 L 8 8 Z",
    stepBack: `M 9 3 V 13 L 2 8 Z ${BAR_RIGHT}`,
    stepForward: `${BAR_LEFT} M 7 3 V 13 L 14 8 Z`,
    continue: "M 1 3 V 13 L 8 8 Z M 8 3 V 13 L 15 8 Z",
    play: "M 4 2 V 14 L 14 8 Z",
    pause: "M 3 3 H 7 V 13 H 3 Z M 9 3 H 13 V 13 H 9 Z",
};

export function icon(name: keyof typeof PATHS): SVGSVGElement {
    const made = element("svg", { width: 14, height: 14, viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true" });
    made.append(element("path", { d: PATHS[name] }));
    return made;
}
