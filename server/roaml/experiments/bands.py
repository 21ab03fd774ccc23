# SPDX-License-Identifier: Apache-2.0
"""What the bands of curves contain."""

from __future__ import annotations

from roaml.exhaustive import Vocabulary


class BandKind(Vocabulary):
    """What a band contains with the stated confidence: the whole curve, or each single value."""

    SIMULTANEOUS = "simultaneous"
    POINTWISE = "pointwise"
