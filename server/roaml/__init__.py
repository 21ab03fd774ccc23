# SPDX-License-Identifier: Apache-2.0
"""The compiler library for HL-SCXML robot models: parse, check, translate, verify.

`roaml.api` is the public interface for other programs. The package does not depend on editors or LSP.
"""

__version__ = "0.2.0"
