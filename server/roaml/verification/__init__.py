# SPDX-License-Identifier: Apache-2.0
"""Verification of the properties of a target, and verdicts on the results.

- A `Target` is a model with the texts that its positions refer to: a translated system or a JANI file.
- A `Verifier` decides the properties of a target. Each `Result` contains the answer, a verdict on each expectation,
  whether traces got stuck, and what is known about other schedulers. If there is no answer, it contains a refusal with
  the reason.
- A result can simulate its traces again: `counterexample` explains the shortest trace that contradicts an expectation.

Nothing here reads or writes files, prints, or depends on editors.
"""
