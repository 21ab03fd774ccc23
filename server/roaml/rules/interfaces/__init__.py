# SPDX-License-Identifier: Apache-2.0
"""Rules about topics, services, actions and timers."""
