# SPDX-License-Identifier: Apache-2.0
"""The compiler library for HL-SCXML robot models: parse, check, translate, verify.

`roaml.api` is the door for other programs. The package knows nothing of editors or of LSP.
"""

__version__ = "0.1.0"
