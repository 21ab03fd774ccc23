# SPDX-License-Identifier: Apache-2.0
"""Rules about states and transitions: targets, order, probabilities."""
