# SPDX-License-Identifier: Apache-2.0
"""The program, as tests run it."""

import os
import subprocess

STANDOFF = os.environ["STANDOFF"]


def run(*words, code=0, says="", **options):
    """What it printed. It must end with this exit code, and say this."""
    ran = subprocess.run([STANDOFF, *map(str, words)], capture_output=True, text=True, timeout=120, **options)
    assert ran.returncode == code and says in ran.stderr, (words, ran.returncode, ran.stderr)
    return ran
