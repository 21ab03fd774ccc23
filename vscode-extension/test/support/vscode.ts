// SPDX-License-Identifier: Apache-2.0
/** Stands in for the editor's module where only its wording is used. */

export const l10n = {
    t: (text: string, ...values: unknown[]): string =>
        text.replaceAll(/\{(\d+)\}/g, (_, index: string) => String(values[Number(index)])),
};
