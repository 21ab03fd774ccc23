// SPDX-License-Identifier: Apache-2.0
/** Converts a result of the model checker to the result of a test. */

import type { Stuckness, Verified } from "../protocol";

const NO_EXPECTATION = "no expectation set";

export type Outcome =
    | {
          readonly kind: "passed";
          readonly short: string;
          readonly milliseconds: number;
          /** The expectations that are met under uniform choices, but not known to be met under all schedulers. */
          readonly uniform: readonly string[];
          /** The number of traces, if none of them contradicts an expected 0 or 1 that the interval leaves open. */
          readonly unanimous: number;
          /** Why the number is doubtful, or is not the value that the property asks for. */
          readonly warning?: string;
          /** The automata that wait for one another, if the system gets stuck. */
          readonly stuck?: string;
      }
    | {
          readonly kind: "failed";
          readonly short: string;
          readonly milliseconds: number;
          /** The expectation that is not met. */
          readonly missed: readonly string[];
          readonly hasCounterexample: boolean;
          readonly warning?: string;
          readonly stuck?: string;
      }
    | {
          /** The test has neither passed nor failed, because no expectation is set. */
          readonly kind: "unjudged";
          readonly short: string;
          readonly warning?: string;
          readonly stuck?: string;
      }
    | { readonly kind: "errored"; readonly message: string };

/** The outcome of a test. If the system gets stuck, it contains this; if that is an error, the test fails. */
export function outcomeOf(verified: Verified, known?: Stuckness | null): Outcome {
    if (verified.error) return { kind: "errored", message: verified.error.message };
    const { short = "", seconds = 0 } = verified;
    const milliseconds = Math.round(seconds * 1000);
    const missed = (verified.expectations ?? []).filter(({ met }) => !met).map(({ expected }) => expected);
    const stuck = known?.example ? { stuck: known.text } : {};
    const warning = verified.warning === undefined ? {} : { warning: verified.warning };
    const isWrong = known?.example && known.level === "error";
    if (verified.verdict === NO_EXPECTATION && !isWrong) return { kind: "unjudged", short, ...warning, ...stuck };
    if (missed.length === 0 && !isWrong) {
        const onlyUniform = (verified.expectations ?? []).filter(
            (expectation) => expectation.under_uniform_choices_only && expectation.uniform !== "accept",
        );
        const uniform = onlyUniform.map(({ expected }) => expected);
        const unanimous = Math.max(
            0,
            ...(verified.expectations ?? []).map((expectation) => expectation.unanimous ?? 0),
        );
        return { kind: "passed", short, milliseconds, uniform, unanimous, ...warning, ...stuck };
    }
    const hasCounterexample = verified.counterexample ?? false;
    return { kind: "failed", short, milliseconds, missed, hasCounterexample, ...warning, ...stuck };
}
