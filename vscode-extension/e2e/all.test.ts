// SPDX-License-Identifier: Apache-2.0
/** Everything that the extension does, in the order in which a user meets it. */

import { describe } from "node:test";
import { editing } from "./editing";
import { firstStart } from "./firstStart";
import { harmony } from "./harmony";
import { life } from "./life";
import { pictures } from "./pictures";
import { restricted } from "./restricted";
import { systems } from "./systems";
import { themes } from "./themes";
import { verification } from "./verification";
import { withoutPython } from "./withoutPython";
import { walkthrough } from "./walkthrough";
import { Stage } from "./support/stage";

// One server and one browser for what needs nothing special: it is what takes long to start.
const stage = new Stage();

describe("first start", () => {
    firstStart(stage);
});
describe("editing", () => {
    editing(stage);
});
describe("systems", () => {
    systems(stage);
});
describe("pictures", () => {
    pictures(stage);
});
describe("verification", () => {
    verification(stage);
});
describe("walkthrough and templates", () => {
    walkthrough(stage);
});
describe("themes", () => {
    themes(stage);
});
describe("life of the server", () => {
    life(stage);
});
describe("harmony with other extensions", () => {
    harmony(stage);
});
describe("restricted mode", () => {
    restricted(stage);
});
describe("without Python", () => {
    withoutPython();
});
