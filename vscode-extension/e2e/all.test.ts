// SPDX-License-Identifier: Apache-2.0
/** End-to-end tests of all features, in the order in which a user encounters them. */

import { describe } from "node:test";
import { debugging } from "./debugging";
import { editing } from "./editing";
import { experiments } from "./experiments";
import { firstStart } from "./firstStart";
import { compatibility } from "./compatibility";
import { serverLifeCycle } from "./serverLifeCycle";
import { journeys } from "./journeys";
import { pictures } from "./pictures";
import { restricted } from "./restricted";
import { systems } from "./systems";
import { walkthroughPictures } from "./themes";
import { loneTrees } from "./trees";
import { verification } from "./verification";
import { withoutPython } from "./withoutPython";
import { walkthrough } from "./walkthrough";
import { Stage } from "./support/stage";

// Tests without special requirements share one server and one browser, which take long to start.
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
describe("journeys", () => {
    journeys(stage);
});
describe("experiments", () => {
    experiments(stage);
});
describe("lone trees", () => {
    loneTrees(stage);
});
describe("debugging", () => {
    debugging(stage);
});
describe("walkthrough and templates", () => {
    walkthrough(stage);
});
describe("themes", () => {
    walkthroughPictures(stage);
});
describe("server life cycle", () => {
    serverLifeCycle(stage);
});
describe("compatibility with other extensions", () => {
    compatibility(stage);
});
describe("restricted mode", () => {
    restricted(stage);
});
describe("without Python", () => {
    withoutPython();
});
