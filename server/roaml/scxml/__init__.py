# SPDX-License-Identifier: Apache-2.0
"""Plain SCXML as frozen data, and its writer. Knows expressions, nothing of HL-SCXML, ROS or JANI."""
