# SPDX-License-Identifier: Apache-2.0
"""The command `standoff`: the program that is in the package."""

from __future__ import annotations

import os
import sys

PROGRAM = os.path.join(os.path.dirname(__file__), "bin", "standoff")


def main() -> None:
    os.execv(PROGRAM, [PROGRAM, *sys.argv[1:]])
