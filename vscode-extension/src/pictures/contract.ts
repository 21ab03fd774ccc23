// SPDX-License-Identifier: Apache-2.0
/**
 * The data of a picture from the server, and the messages between the extension and the view that draws it.
 *
 * Positions are those of LSP: lines and UTF-16 columns from 0.
 */

export type PictureKind = "machine" | "tree" | "ros" | "system";

export interface Position {
    readonly line: number;
    readonly character: number;
}

export interface Place {
    readonly uri: string;
    readonly range: { readonly start: Position; readonly end: Position };
}

export const NODE_KINDS = [
    "state",
    "choice",
    "thread",
    "group",
    "machine",
    "control",
    "decorator",
    "action",
    "condition",
    "subtree",
    "variable",
    "namespace",
    "node",
    "plugin",
    "topic",
    "service",
    "action-interface",
] as const;

export type NodeKind = (typeof NODE_KINDS)[number];

export const EDGE_KINDS = [
    "eventless",
    "event",
    "ros",
    "bt",
    "child",
    "reads",
    "writes",
    "publishes",
    "subscribes",
    "serves",
    "calls",
    "sends",
] as const;

export type EdgeKind = (typeof EDGE_KINDS)[number];

/** The actions that change the text, in the order of the menu. */
export const PICTURE_ACTIONS = [
    "addState",
    "addTransition",
    "addChild",
    "addAfter",
    "rename",
    "setName",
    "setInitial",
    "changeNode",
    "wrap",
    "unwrap",
    "moveEarlier",
    "moveLater",
    "deleteTransition",
    "delete",
] as const;
export type PictureAction = (typeof PICTURE_ACTIONS)[number];

export interface Point {
    readonly x: number;
    readonly y: number;
}

export interface Box extends Point {
    readonly width: number;
    readonly height: number;
}

/** The place of a node; `index` is its index in the picture. */
export interface DrawnNode extends Box {
    readonly index: number;
}

/**
 * A drawing of the server. `scene` is an SVG group without a namespace, whose colors come from the style sheet. In it,
 * nodes have the attribute `data-node`, edges `data-edges`: the indexes in the picture.
 */
export interface Drawing {
    readonly width: number;
    readonly height: number;
    readonly scene: string;
    readonly nodes: readonly DrawnNode[];
}

/** A node. `parent` is the id of the node that contains it in the drawing; "" if there is none. */
export interface PictureNode {
    readonly id: string;
    readonly kind: NodeKind;
    readonly label: string;
    readonly details: readonly string[];
    readonly parent: string;
    /** The ids of the nodes that it replaces: those in a collapsed group or namespace, or interfaces in the card of a node. */
    readonly hides: readonly string[];
    readonly initial: boolean;
    /** The place in a file that the node represents; that of a subtree is its `<BehaviorTree>`. */
    readonly place: Place | null;
    /** The actions that the place allows. */
    readonly actions: readonly PictureAction[];
    /** The place of the `<SubTree>` of a subtree, and the actions that this place allows. */
    readonly use: Place | null;
    readonly useActions: readonly PictureAction[];
}

export interface PictureEdge {
    readonly source: string;
    readonly target: string;
    readonly kind: EdgeKind;
    readonly labels: readonly string[];
    readonly probabilistic: boolean;
    /** The kind of the interfaces through which it leads, if their nodes are not shown; their names are `labels`. */
    readonly interface: NodeKind | "";
    readonly place: Place | null;
    readonly actions: readonly PictureAction[];
}

export interface Picture {
    readonly kind: PictureKind;
    readonly title: string;
    readonly nodes: readonly PictureNode[];
    readonly edges: readonly PictureEdge[];
    /** The drawings in the directions of `DIRECTIONS`. Only trees have outlines. */
    readonly drawings: readonly Drawing[];
}

export const DIRECTIONS = ["down", "right", "outline", "wide-outline"] as const;
export type Direction = (typeof DIRECTIONS)[number];

export const THEMES = ["light", "dark", "high-contrast", "high-contrast-light"] as const;
export type Theme = (typeof THEMES)[number];

/** A node or an edge by its index in the picture. */
export type Part = { readonly node: number } | { readonly edge: number };

/** Where a run stops: before a line, from 0, or when a topic, service or action sends or receives. */
export type Breakpoint =
    | { readonly label: string; readonly uri: string; readonly line: number }
    | { readonly label: string; readonly event: string };

/** Some parts of a picture, by their indexes. */
export interface MarkedParts {
    readonly nodes: readonly number[];
    readonly edges: readonly number[];
}

/** A part as the commands of the context menu receive it. Transitions that share a line are several parts. */
export interface MenuPart {
    readonly label: string;
    readonly place: Place;
    readonly actions: readonly PictureAction[];
}

/** The data of the context menu, which VS Code reads from the elements of the page. Its keys are context keys. */
export type MenuContext = {
    readonly preventDefaultContextMenuItems: true;
    readonly as2fmParts: readonly MenuPart[];
    readonly as2fmBreakpoints: readonly Breakpoint[];
    readonly as2fmGoTo: boolean;
    readonly as2fmStops: boolean;
} & Readonly<Record<`as2fm_${PictureAction}`, boolean>>;

/** The texts of the view, in the language of the user. */
/**
 * The part of a ROS graph that is shown: the nodes that contain all words of a text and what is connected to them, and
 * the neighbourhood of the node with an id. "" shows all.
 */
export interface GraphPart {
    readonly matching: string;
    readonly around: string;
}

export const WHOLE: GraphPart = { matching: "", around: "" };

export interface Words {
    readonly search: string;
    readonly onlyResults: string;
    readonly showAll: string;
    readonly outline: string;
    readonly outlineHint: string;
    readonly zoomIn: string;
    readonly zoomOut: string;
    readonly fit: string;
    readonly saveSvg: string;
    readonly savePng: string;
    readonly savePdf: string;
    readonly nothing: string;
    /** The result of a search that is selected: its name, its number, and the number of results. */
    readonly match: string;
    readonly help: string;
    readonly kinds: Readonly<Record<NodeKind | EdgeKind, string>>;
    /** The words of the legend for a mock, an initial state, and a state which no transition leaves. */
    readonly mock: string;
    readonly initial: string;
    readonly final: string;
    readonly byChance: string;
    /** What the looks of active nodes mean, for screen readers. */
    readonly looks: Readonly<Record<string, string>>;
    readonly breakpoint: string;
    readonly mocks: string;
    readonly probability: string;
    readonly seconds: string;
    readonly verify: string;
    readonly unverified: string;
    readonly verifying: string;
    readonly coverage: CoverageWords;
}

/** The texts about coverage; `{0}` and `{1}` are numbers of traces. */
export interface CoverageWords {
    readonly show: string;
    readonly hint: string;
    readonly all: string;
    readonly some: string;
    readonly none: string;
    /** A short form of `none`, for the picture. */
    readonly never: string;
    /** Which traces were read: their number, that of the verification, and the file. */
    readonly part: string;
    /** The entries of the legend. */
    readonly inAll: string;
    readonly inSome: string;
    readonly inNone: string;
    readonly notVerified: string;
    readonly stale: string;
    readonly returned: string;
}

/** A state or a node of a tree: the traces that have entered or ticked it, and those that saw it return a status. */
export interface CoveredNode {
    readonly traces: number;
    readonly statuses: Readonly<Record<string, number>>;
}

/**
 * What the traces of the last verification have executed of a picture. `nodes` and `edges` belong to those of the
 * picture, in their order; null for a part that is not executed. They are empty if the files have changed since then.
 */
export interface Coverage {
    /** The traces that were read; the verification has `simulated` traces. */
    readonly traces: number;
    readonly simulated: number;
    readonly isStale: boolean;
    /** The URI of the system or tree that was verified. */
    readonly system: string;
    readonly nodes: readonly (CoveredNode | null)[];
    readonly edges: readonly (number | null)[];
}

/** Fields for a mock of leaves. `nodes` are the ids of the leaves; `milliseconds` is null if it has no duration. */
export interface MockField {
    readonly pattern: string;
    readonly kind: string;
    readonly probability: number;
    readonly milliseconds: number | null;
    readonly origin: string;
    readonly reason: string;
    readonly nodes: readonly string[];
}

/** The mocks of a tree, and its known result in a few words. */
export interface MockFields {
    readonly rows: readonly MockField[];
    readonly result: string;
    readonly problem: string;
}

/** The looks of active nodes, by their ids, and the active edges with the ids of their ends. */
export interface Activity {
    readonly nodes: Readonly<Record<string, string>>;
    readonly edges: readonly { readonly from: string; readonly to: string }[];
}

/** The formats of files with pictures. */
export type PictureFormat = "svg" | "png" | "pdf";

export type ToView =
    | { readonly type: "words"; readonly words: Words }
    | {
          readonly type: "show";
          readonly picture: Picture;
          readonly part: GraphPart;
          readonly here: Part | null;
          readonly highlighted: string;
      }
    | { readonly type: "here"; readonly here: Part | null }
    /** Highlight the node with an id; "" removes the highlight. */
    | { readonly type: "highlight"; readonly node: string }
    /** Show what a run does, instead of what was shown before. */
    | { readonly type: "activity"; readonly activity: Activity }
    /** Mark the parts that have a breakpoint, and no others. */
    | { readonly type: "breakpoints"; readonly parts: MarkedParts }
    /** Convert the text of an SVG file to PNG. */
    | { readonly type: "rasterize"; readonly svg: string }
    /** The mocks of the shown tree; null if it belongs to a system. `opens` shows the fields. */
    | { readonly type: "mocks"; readonly mocks: MockFields | null; readonly busy: boolean; readonly opens: boolean }
    /** The coverage of the shown picture; null if nothing was verified. */
    | { readonly type: "coverage"; readonly coverage: Coverage | null }
    | { readonly type: "none"; readonly reason: string };

export type FromView =
    | { readonly type: "ready" }
    /** Hide the nodes below the node with an id, or those in a namespace, or show them again. */
    | { readonly type: "collapse"; readonly node: string }
    /** Show a part of a ROS graph, instead of the part that was shown before. */
    | { readonly type: "part"; readonly part: GraphPart }
    | { readonly type: "jump"; readonly place: Place; readonly beside: boolean }
    | { readonly type: "save"; readonly format: PictureFormat; readonly direction: Direction; readonly theme: Theme }
    | {
          readonly type: "setMock";
          readonly pattern: string;
          readonly probability: number;
          readonly milliseconds: number | null;
      }
    | { readonly type: "verify" }
    /** Whether the coverage of the last verification is shown. */
    | { readonly type: "coverage"; readonly shows: boolean }
    /** Set a breakpoint on a part, or remove it. */
    | { readonly type: "breakpoint"; readonly breakpoint: Breakpoint }
    /** Undo or redo the last change of the text. */
    | { readonly type: "undo" | "redo" }
    /** The answer to `rasterize`: the PNG file in base64. */
    | { readonly type: "png"; readonly data: string }
    /** Sent after the picture has been drawn. */
    | { readonly type: "drawn"; readonly nodes: number; readonly edges: number };
