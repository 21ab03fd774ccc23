// SPDX-License-Identifier: Apache-2.0
/** Maps places in the plain SCXML of a machine to its source and back. */

import type { PlainLine } from "../protocol";
import type { Position } from "../pictures/contract";

/** The line of the plain form that comes from a position in the source: from the smallest place that contains it. */
export function lineOf(lines: readonly PlainLine[], uri: string, position: Position): number | undefined {
    const around = lines.filter((line) => line.uri === uri && contains(line, position));
    if (around.length === 0) {
        const above = lines.filter((line) => line.uri === uri && line.range.start.line <= position.line);
        return latest(above)?.line;
    }
    return around.reduce((best, line) => (height(line) < height(best) ? line : best)).line;
}

/** The place in the source of a line of the plain form. A line without a place has that of the nearest line above it. */
export function placeOf(lines: readonly PlainLine[], line: number): PlainLine | undefined {
    return lines.filter((place) => place.line <= line).at(-1);
}

function latest(lines: readonly PlainLine[]): PlainLine | undefined {
    return lines.reduce<PlainLine | undefined>(
        (best, line) => (best && best.range.start.line >= line.range.start.line ? best : line),
        undefined,
    );
}

function contains({ range: { start, end } }: PlainLine, { line, character }: Position): boolean {
    const after = line > start.line || (line === start.line && character >= start.character);
    return after && (line < end.line || (line === end.line && character <= end.character));
}

function height({ range: { start, end } }: PlainLine): number {
    return (end.line - start.line) * 10_000 + end.character - start.character;
}
