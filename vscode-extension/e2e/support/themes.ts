// SPDX-License-Identifier: Apache-2.0
/** The themes in which pictures are taken. */

const ALL = {
    light: "Default Light Modern",
    dark: "Default Dark Modern",
    "hc-light": "Default High Contrast Light",
    "hc-dark": "Default High Contrast",
};

type Look = keyof typeof ALL;

/**
 * The themes of a test, by the names in its pictures: `pictured` with `npm run e2e -- --pictures`, otherwise only
 * `tested`.
 */
export function themes(tested: Look, ...pictured: readonly Look[]): [look: Look, theme: string][] {
    const looks = process.env["AS2FM_PICTURES"] === undefined ? [tested] : pictured;
    return looks.map((look) => [look, ALL[look]]);
}
