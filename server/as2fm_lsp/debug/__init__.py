# SPDX-License-Identifier: Apache-2.0
"""The debug adapter: the Debug Adapter Protocol over two streams, on top of `roaml.debugging`."""
