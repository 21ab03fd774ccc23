// SPDX-License-Identifier: Apache-2.0
/** A text with at most a number of characters: as many whole words as fit, if a first one does, and an ellipsis. */
export function shortened(text: string, most: number): string {
    if (text.length <= most) return text;
    const start = text.slice(0, most - 1);
    const space = text[most - 1] === " " ? start.length : start.lastIndexOf(" ");
    return `${(space > 0 ? start.slice(0, space) : start).trimEnd()}…`;
}
