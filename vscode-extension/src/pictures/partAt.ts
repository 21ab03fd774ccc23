// SPDX-License-Identifier: Apache-2.0
import type { Part, Picture, Place, Position } from "./contract";

/** The part of a picture whose source contains the caret. The innermost part is used; of equal parts, the edge. */
export function partAt(picture: Picture, uri: string, position: Position): Part | null {
    let best: Part | null = null;
    let narrowest: Place | undefined;
    const consider = (place: Place | null, part: Part) => {
        if (place?.uri !== uri || !contains(place, position)) return;
        if (narrowest === undefined || isInside(place, narrowest)) [narrowest, best] = [place, part];
    };
    picture.nodes.forEach((node, index) => {
        consider(node.place, { node: index });
        consider(node.use, { node: index });
    });
    picture.edges.forEach((edge, index) => {
        consider(edge.place, { edge: index });
    });
    return best;
}

function contains({ range }: Place, position: Position): boolean {
    return !isBefore(position, range.start) && !isBefore(range.end, position);
}

function isInside(inner: Place, outer: Place): boolean {
    return (
        !isBefore(inner.range.start, outer.range.start) &&
        !isBefore(outer.range.end, inner.range.end) &&
        !(isSame(inner.range.start, outer.range.start) && isSame(inner.range.end, outer.range.end))
    );
}

function isBefore(a: Position, b: Position): boolean {
    return a.line < b.line || (a.line === b.line && a.character < b.character);
}

function isSame(a: Position, b: Position): boolean {
    return a.line === b.line && a.character === b.character;
}
