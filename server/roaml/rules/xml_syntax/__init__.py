# SPDX-License-Identifier: Apache-2.0
"""Rules about XML itself: tags, attributes, entities, encodings."""
