# SPDX-License-Identifier: Apache-2.0
"""Pages for users, those under "Start" and "How to" on the site and those of files: each is short, has a picture of its own,
and shows an example before it promises anything. Every picture in docs/images is shown somewhere."""

import os
import re
import sys
from pathlib import Path

SOURCE = Path(os.environ["STANDOFF_SOURCE_DIR"])
DOCS = SOURCE / "docs"
MOST_WORDS = 1500
MORE = ["formats", "zarr"]
# Of reference pages: tables that a program is held against, or that are looked up word by word.
LONG = ["json", "glossary"]
# No picture says what they are about.
PLAIN = ["python_arrays"]


def listed(caption):
    toctree = re.search(rf"^:caption: {caption}\n:hidden:\n\n(.*?)^```", (DOCS / "site/index.md").read_text(), re.M | re.S)[1]
    return [name for name in toctree.split() if (DOCS / f"{name}.md").exists()]


def pictures(text):
    return re.findall(r"!\[[^\]]+\]\((?:docs/)?images/([^)]+)\)", text)


def faults_of(name):
    text = (DOCS / f"{name}.md").read_text()
    if not pictures(text) and name not in PLAIN:
        yield "has no picture"
    if not re.match(r"# .*\n\n[A-Z`]", text):
        yield "does not begin with a sentence about what it is for"
    example, promise = text.find("```"), re.search(r"\*\*(Guarantees?|Promise|Takes)\b|^#+ Guarantee|exact\.\*\*", text, re.M)
    if not 0 < example < 4000:
        yield "does not begin with an example"
    if promise and promise.start() < example:
        yield f"promises ({promise[0]}) before it shows an example"


def main():
    users = [*listed("Start"), *listed("How to"), *MORE]
    if len(users) < 20:
        sys.exit(f"only {users} are listed; are the captions as they were?")
    wrong = [f"docs/{name}.md {fault}" for name in users for fault in faults_of(name)]
    for name in dict.fromkeys([*users, *listed("Reference")]):
        words = len((DOCS / f"{name}.md").read_text().split())
        if words > MOST_WORDS and name not in LONG:
            wrong.append(f"docs/{name}.md has {words} words, more than {MOST_WORDS}: cut, or move what explains to a page of its own")
    first = {name: pictures((DOCS / f"{name}.md").read_text())[:1] for name in users}
    for name, own in first.items():
        wrong += [f"docs/{name}.md and docs/{other}.md begin with the same picture" for other in first if own and other < name and first[other] == own]
    shown = {picture for page in [SOURCE / "README.md", *DOCS.glob("*.md")] for picture in pictures(page.read_text())}
    wrong += [f"docs/images/{file.name} is shown nowhere" for file in (DOCS / "images").iterdir() if file.name not in shown]
    films = sum(file.stat().st_size for file in (DOCS / "images").glob("*.webp"))
    if not 0 < films < 2_000_000:
        wrong.append(f"the films take {films} bytes")
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"{len(users)} pages for users")


main()
