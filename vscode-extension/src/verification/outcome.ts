// SPDX-License-Identifier: Apache-2.0
/** What an answer of the model checker is as the result of a test. */

import type { Verified } from "../protocol";

export type Outcome =
    | { readonly kind: "passed"; readonly short: string; readonly milliseconds: number }
    | {
          readonly kind: "failed";
          readonly short: string;
          readonly milliseconds: number;
          /** What was expected and is not so. */
          readonly missed: readonly string[];
          readonly hasCounterexample: boolean;
      }
    | { readonly kind: "errored"; readonly message: string };

/** A property of which nothing is expected passes: its probability is what was asked for. */
export function outcomeOf(verified: Verified): Outcome {
    if (verified.error) return { kind: "errored", message: verified.error.message };
    const { short = "", seconds = 0 } = verified;
    const milliseconds = Math.round(seconds * 1000);
    const missed = (verified.expectations ?? []).filter(({ met }) => !met).map(({ expected }) => expected);
    if (missed.length === 0) return { kind: "passed", short, milliseconds };
    return { kind: "failed", short, milliseconds, missed, hasCounterexample: verified.counterexample ?? false };
}
