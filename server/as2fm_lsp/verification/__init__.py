# SPDX-License-Identifier: Apache-2.0
"""Reports of verification results, for the command line and the server."""
