// SPDX-License-Identifier: Apache-2.0
/** Where the focus goes when the user moves it to a page, for example with a key of the editor. */

/**
 * Give the focus to an element when the page receives it. Otherwise the page itself has it, whose keys do nothing, and of
 * which a screen reader says only the title.
 */
export function receiveFocus(element: () => HTMLElement | SVGElement | undefined): void {
    window.addEventListener("focus", () => {
        const { activeElement, body } = document;
        if (activeElement === null || activeElement === body) element()?.focus({ preventScroll: true });
    });
}
