# SPDX-License-Identifier: Apache-2.0
"""The command `standoff`: the program that is in the package."""

from __future__ import annotations

import os
import sys


def main() -> None:
    program = os.path.join(os.path.dirname(__file__), "bin", "standoff")
    os.execv(program, [program, *sys.argv[1:]])
