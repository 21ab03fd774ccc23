# SPDX-License-Identifier: Apache-2.0
"""The files of the conformance set, which stands beside the repository and may be absent."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SET = ROOT.parent / "shared" / "conformance"

REFERENCES = sorted((SET / "reference").glob("*.jani.gz"))
"""Whole models, compressed."""

WHOLE_MODELS = sorted((SET / "models" / "battery_example").glob("*.jani"))
PROPERTY_FILES = sorted(set((SET / "models").glob("*/**/*.jani")) - set(WHOLE_MODELS))
