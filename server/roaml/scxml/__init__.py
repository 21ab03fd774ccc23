# SPDX-License-Identifier: Apache-2.0
"""Plain SCXML as frozen data, and its writer. Depends on expressions, not on HL-SCXML, ROS or JANI."""
