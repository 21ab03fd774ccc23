# SPDX-License-Identifier: Apache-2.0
"""Verifying the properties of a target, and judging the answers.

- A `Target` is a model with the texts in which its places are: a translated system or a JANI file.
- A `Verifier` answers its properties. Each `Result` holds the answer, a verdict on each expectation, whether traces got
  stuck, what is known of other schedulers, or a refusal that says why there is no answer.
- A result can walk its traces again: `counterexample` explains the shortest one that speaks against an expectation.

Nothing here reads or writes files, prints, or knows of editors.
"""
