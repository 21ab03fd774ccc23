# SPDX-License-Identifier: Apache-2.0
"""Rules about behavior trees, their plugins, ports and the blackboard."""
