// SPDX-License-Identifier: Apache-2.0
/** Exports a picture as a file that contains the colors of the theme, so that it looks the same everywhere. */

import { element, markers } from "./draw";

const PROPERTIES = [
    "fill",
    "stroke",
    "stroke-width",
    "stroke-dasharray",
    "stroke-linecap",
    "opacity",
    "font-family",
    "font-size",
    "font-weight",
    "font-style",
    "text-anchor",
];
const MARGIN = 16;
const SCALE = 2;

export interface Size {
    readonly width: number;
    readonly height: number;
}

/** The text of an SVG file. */
export function svgText(shown: SVGSVGElement, scene: SVGGElement, size: Size): string {
    const [width, height] = [size.width + 2 * MARGIN, size.height + 2 * MARGIN];
    const copy = element("svg", {
        xmlns: "http://www.w3.org/2000/svg",
        viewBox: `${-MARGIN} ${-MARGIN} ${width} ${height}`,
        width,
        height,
    });
    const background = getComputedStyle(document.body).backgroundColor;
    copy.append(element("rect", { x: -MARGIN, y: -MARGIN, width, height, fill: background }));
    const defs = shown.querySelector("defs");
    if (defs) copy.append(styled(defs, markers()));
    const content = styled(scene, scene.cloneNode(true) as SVGGElement);
    content.removeAttribute("transform");
    for (const each of content.querySelectorAll(".wide")) each.remove();
    for (const each of content.querySelectorAll("[tabindex]")) each.removeAttribute("tabindex");
    copy.append(content);
    return new XMLSerializer().serializeToString(copy);
}

/** The base64 text of a PNG file. */
export async function pngData(svg: string, size: Size): Promise<string> {
    const url = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
    try {
        const image = new Image();
        image.src = url;
        await image.decode();
        const canvas = document.createElement("canvas");
        canvas.width = (size.width + 2 * MARGIN) * SCALE;
        canvas.height = (size.height + 2 * MARGIN) * SCALE;
        canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
        return canvas.toDataURL("image/png").replace(/^data:[^,]*,/, "");
    } finally {
        URL.revokeObjectURL(url);
    }
}

/** Write the computed style of `original` into `copy`. */
function styled<T extends Element>(original: Element, copy: T): T {
    const style = getComputedStyle(original);
    for (const property of PROPERTIES) {
        const value = style.getPropertyValue(property);
        if (value !== "") copy.setAttribute(property, value);
    }
    [...original.children].forEach((child, i) => {
        const other = copy.children[i];
        if (other) styled(child, other);
    });
    return copy;
}
