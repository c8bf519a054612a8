#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The fenced blocks of README.md and docs/*.md, and README.md as a session in a shell.

    tests/docs/snippets.py > session.sh

prints the session: what README.md tells a new user to type, in order, and the files that it shows, written where it says.
Run it with `URL=... bash session.sh` in an empty folder (CONTRIBUTING.md, "A clean machine")."""
import pathlib
import re
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
README = SOURCE / "README.md"
PAGES = sorted((SOURCE / "docs").glob("*.md"))
LANGUAGES = ("sh", "cpp", "cmake", "python", "text", "")  # python: run by python/tests/guide_test.py


def blocks(page):
    """(language, text, file) of each block; file is what the paragraph before it names, as in "`app/app.cpp`:"."""
    for match in re.finditer(r"^(?:`([^`\n]+)`:\n\n)?```(\w*)\n(.*?)^```$", page.read_text(), re.M | re.S):
        file, language, text = match.groups()
        if language not in LANGUAGES:
            sys.exit(f"{page}: a block of '{language}', which no test runs; teach {__file__} to")
        yield language, text, file


def session(page):
    """What the page's blocks do, as a script for bash: every command is printed before it runs."""
    lines = ["set -euo pipefail", "set -x"]
    for language, text, file in blocks(page):
        if language == "sh":
            lines.append(text)
        elif language in ("cpp", "cmake"):
            if file is None:
                sys.exit(f"{page}: a block of {language} without a file; name it on the line before, as in `app/app.cpp`:")
            lines.append(f"mkdir -p {pathlib.Path(file).parent}\ncat > {file} <<'END_OF_FILE'\n{text}END_OF_FILE\n")
    return "\n".join(lines)


if __name__ == "__main__":
    print(session(README))
