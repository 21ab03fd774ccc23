# SPDX-License-Identifier: Apache-2.0
"""Rules about plain events and the data that events carry."""
