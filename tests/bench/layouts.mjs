// SPDX-License-Identifier: Apache-2.0
// Lays out graphs with ELK: reads a list of {nodes, links, aspect} from standard input, and writes for each one the boxes
// of its nodes and labels and the lines of its links. `elkjs` is found beside the working folder.
import { createRequire } from "node:module";
import * as path from "node:path";
import { text } from "node:stream/consumers";

const ELK = createRequire(path.join(process.cwd(), "here.js"))("elkjs");
const elk = new ELK();
const OPTIONS = {
    "elk.algorithm": "layered",
    "elk.direction": "DOWN",
    "elk.edgeRouting": "ORTHOGONAL",
    "elk.layered.wrapping.strategy": "MULTI_EDGE",
    "elk.layered.feedbackEdges": "true",
    "elk.edgeLabels.placement": "CENTER",
    "elk.layered.nodePlacement.strategy": "BRANDES_KOEPF",
    "elk.spacing.nodeNode": "28",
    "elk.layered.spacing.nodeNodeBetweenLayers": "22",
};
const done = [];
for (const { nodes, links, aspect } of JSON.parse(await text(process.stdin))) {
    const graph = {
        id: "root",
        layoutOptions: { ...OPTIONS, "elk.aspectRatio": String(aspect) },
        children: nodes.map(([id, width, height]) => ({ id, width, height })),
        edges: links.map(([source, target, width, height], index) => ({
            id: `edge ${index}`,
            sources: [source],
            targets: [target],
            labels: width === 0 ? [] : [{ id: `label ${index}`, text: "x", width, height }],
        })),
    };
    const laid = await elk.layout(graph);
    done.push({
        width: laid.width,
        height: laid.height,
        lines: laid.edges.map(({ sections = [] }) =>
            sections.map(({ startPoint, bendPoints = [], endPoint }) =>
                [startPoint, ...bendPoints, endPoint].map(({ x, y }) => [x, y]),
            ),
        ),
    });
}
process.stdout.write(JSON.stringify(done));
