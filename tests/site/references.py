# SPDX-License-Identifier: Apache-2.0
"""references.py FOLDER: nothing is missing in the site: no page of docs, no comment and no name of the public headers, no
name of the Python package."""

import ast
import html
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def words_of(page: Path) -> str:
    """What is written on a page, without marks and spaces."""
    text = re.sub(r"<(script|style|nav|aside).*?</\1>", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return bare(html.unescape(re.sub(r"<[^>]*>", "", text)))


def bare(text: str) -> str:
    # Quotes and dashes are written as print writes them; addresses of pages as their titles.
    return re.sub(r"[^A-Za-z0-9]", "", text)


def comments(text: str) -> list[str]:
    """The comments of a header, a piece for each unbroken run of words between links to pages."""
    text = re.sub(r"namespace detail \{.*?\n\}  // namespace detail", "", text, flags=re.DOTALL)
    text = re.sub(r"\n( *)private:\n.*?\n( *)\};", "\n", text, flags=re.DOTALL)
    found = []
    for block in re.findall(r"(?:^ *///(?!<).*\n)+|///<.*\n(?: +///<.*\n)*", text, re.MULTILINE):
        words = " ".join(re.sub(r"^ *///<?", "", line) for line in re.sub(r"^.*?(?=///)", "", block).splitlines())
        found += re.split(r"\(?docs/\w+\.md|standoff/\w+\.h", words)
    return found


def missing_comments(folder: Path):
    for header in sorted((ROOT / "include/standoff").glob("*.h")):
        text = header.read_text()
        if not re.search(r"^(struct|class|enum|inline|constexpr|STANDOFF_API|using|template|///)", text, re.MULTILINE):
            continue
        page = folder / "cpp" / f"{header.stem}.html"
        if not page.exists():
            yield f"{header.name}: it has no page"
            continue
        shown = words_of(page)
        for comment in comments(text):
            if bare(comment) not in shown:
                yield f"{header.name}: its page lacks the comment: {comment.strip()}"
        for name in re.findall(r"^STANDOFF_API [^(=]*?(\w+)\(", text, re.MULTILINE) + re.findall(
            r"^(?:struct|class|enum class) (?:STANDOFF_API )?(\w+)(?= [{:])", text, re.MULTILINE
        ):
            if 'id="_CPPv' not in page.read_text() or bare(name) not in shown:
                yield f"{header.name}: its page lacks {name}"


def missing_names(folder: Path):
    tree = ast.parse((ROOT / "python/standoff/__init__.py").read_text())
    for node in tree.body:
        if isinstance(node, ast.Assign) and node.targets[0].id == "__all__":
            names = ast.literal_eval(node.value)
    shown = "".join(page.read_text() for page in folder.glob("python_*.html"))
    for name in names:
        if not name.startswith("__") and f'id="standoff.{name}"' not in shown:
            yield f"standoff.{name}: no page documents it; add it to one of docs/site/python_*.md"


def missing_pages(folder: Path):
    start = (folder / "index.html").read_text()
    for page in (ROOT / "docs").glob("*.md"):
        if f'href="{page.stem}.html"' not in start:
            yield f"docs/{page.name}: the menu does not lead to it"


def main(folder: Path) -> None:
    wrong = [*missing_comments(folder), *missing_names(folder), *missing_pages(folder)]
    if wrong:
        sys.exit("\n".join(wrong))
    print("every page, every comment of the headers and every name of the package is there")


main(Path(sys.argv[1]).resolve())
