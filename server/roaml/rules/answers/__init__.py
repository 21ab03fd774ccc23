# SPDX-License-Identifier: Apache-2.0
"""Rules about ticks, halts, requests and goals that a machine must answer."""
