# SPDX-License-Identifier: Apache-2.0
"""Documents of the rules about parameters and instances, whose findings come from their expansion."""
