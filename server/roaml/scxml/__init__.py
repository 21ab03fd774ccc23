# SPDX-License-Identifier: Apache-2.0
"""Plain SCXML as immutable data, and its writer. The package depends on expressions, but not on HL-SCXML, ROS or
JANI."""
