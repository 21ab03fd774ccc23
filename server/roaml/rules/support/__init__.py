# SPDX-License-Identifier: Apache-2.0
"""What several rules use. Rules do not import each other."""
