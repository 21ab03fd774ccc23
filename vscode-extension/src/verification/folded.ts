// SPDX-License-Identifier: Apache-2.0
/** A long text above a list, of which the list has the rest. Independent of VS Code. */

/** About three lines of a view that has half of the panel. */
export const MAX_MESSAGE_LENGTH = 150;
/** About one line of it. */
const MAX_LINE_LENGTH = 64;

export interface Folded {
    readonly message: string;
    /** The whole text in lines, if the message is not the whole text. */
    readonly lines: readonly string[];
}

/** The text itself if it is short, otherwise a summary of it. */
export function folded(text: string, summary: string): Folded {
    if (text.length <= MAX_MESSAGE_LENGTH) return { message: text, lines: [] };
    return { message: summary, lines: wrapped(text) };
}

function wrapped(text: string): string[] {
    const lines: string[] = [];
    for (const word of text.split(" ")) {
        const last = lines.at(-1);
        if (last !== undefined && last.length + word.length < MAX_LINE_LENGTH)
            lines[lines.length - 1] = `${last} ${word}`;
        else lines.push(word);
    }
    return lines;
}
