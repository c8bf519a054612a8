# SPDX-License-Identifier: Apache-2.0
"""Puts what the site is made of into one folder: pages of the repository, with links that work there, and the C++ reference.

    stage.py FOLDER

A page keeps its words. Its links to other pages lead to them, by their titles where it wrote their paths; those to files
that are not in the site become plain text. STANDOFF names the program, of whose verbs there are pages."""

from __future__ import annotations

import json
import os
import posixpath
import re
import shutil
import subprocess
import sys
from pathlib import Path

SITE = Path(__file__).resolve().parent
ROOT = SITE.parents[1]
sys.path.insert(0, str(SITE))

import cpp_pages

# Pages of the repository that keep their names in lower case at the top of the site.
PROJECT = {"ARCHITECTURE.md": "architecture", "CONTRIBUTING.md": "contributing", "CHANGELOG.md": "changelog"}
# They are no pages, but parts of them are on the start page.
PARTS = {"README.md": "index", "python/README.md": "index"}
FENCE = re.compile(r"^ *(```|~~~)")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")


def pages() -> dict[str, str]:
    """The site's pages: path in the repository -> name in the site."""
    found = {f"docs/{path.name}": path.stem for path in sorted((ROOT / "docs").glob("*.md"))}
    found |= {f"docs/site/{path.name}": path.stem for path in sorted(SITE.glob("*.md"))}
    notebooks = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))
    found |= {f"docs/notebooks/{path.name}": f"notebooks/{path.stem}" for path in notebooks}
    return found | PROJECT


def anchors(text: str) -> set[str]:
    """The anchors of a page's headings."""
    found = set()
    fenced = False
    for line in text.splitlines():
        fenced ^= bool(FENCE.match(line))
        if not fenced and (match := re.match(r"#+ +(.*)", line)):
            found.add(re.sub(r"[^\w\- ]", "", match[1].lower().strip()).replace(" ", "-"))
    return found


def with_links(text: str, here: str, known: dict[str, str]) -> str:
    """The text of the page at the path `here`, with links as they must be at its place in the site."""
    place = posixpath.dirname(known.get(here, "index"))

    def link(match: re.Match) -> str:
        picture, words, target = match.groups()
        path, _, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target) or not path:
            return match[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(here), path))
        if not (ROOT / path).exists():
            sys.exit(f"{here}: links to {target}, which does not exist")
        if picture:
            source = path.removeprefix("docs/")
            return f"![{words}]({posixpath.relpath(source, place or '.')})"
        if path in known:
            suffix = ".ipynb" if path.endswith(".ipynb") else ".md"
            to = posixpath.relpath(known[path] + suffix, place or ".")
            if re.fullmatch(
                r"[\w/]+\.md", words
            ):  # a path says nothing to readers of the site; the builder puts the title
                words = ""
            return f"[{words}]({to}{'#' + anchor if anchor else ''})"
        if path in PARTS and (not anchor or anchor in anchors(start_page())):
            return f"[{words}](index.md{'#' + anchor if anchor else ''})"
        return words

    # Code is not prose: what looks like a link in it is none.
    parts = re.split(r"(^ *```.*?^ *```[^\S\n]*$|`[^`\n]+`(?!\]\())", text, flags=re.MULTILINE | re.DOTALL)
    merged, code = "", []
    for n, part in enumerate(parts):
        if n % 2 and part.lstrip().startswith("```"):
            code.append(part)
            merged += f"\0{len(code) - 1}\0"
        else:
            merged += part
    merged = LINK.sub(link, merged)
    return re.sub(r"\0(\d+)\0", lambda m: code[int(m[1])], merged)


def notebook(text: str, here: str, known: dict[str, str]) -> str:
    """A notebook with links that work in the site."""
    content = json.loads(text)
    content["metadata"].setdefault("language_info", {"name": "python"})
    for cell in content["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = with_links("".join(cell["source"]), here, known)
    return json.dumps(content, indent=1)


def start_page() -> str:
    """What is on the start page: with the parts of the README that it includes."""
    readme = (ROOT / "README.md").read_text()
    parts = [readme.partition("## Start")[0], readme.partition("## Promises")[2].partition("## Conventions")[0]]
    return "\n".join([(SITE / "index.md").read_text(), *parts])


def other_pages(index: str, known: dict[str, str]) -> list[str]:
    """Pages that the start page does not name: new ones get into the site without being listed."""
    named = set(re.findall(r"^[\w/]+$", index, re.MULTILINE))
    return [
        name for path, name in known.items() if name not in named and path.startswith("docs/") and path.count("/") == 1
    ]


def write_verbs(program: str, folder: Path) -> str:
    """Writes a page for each verb of the program; returns the table that leads to them."""
    ask = lambda *arguments: subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout
    folder.mkdir()
    rows = ["| verb | what it does |", "|---|---|"]
    verbs = ask("man", "--list").split()
    for verb in verbs:
        page = ask("man", verb, "--markdown")
        (folder / f"{verb}.md").write_text(page)
        rows.append(f"| [{verb}](verbs/{verb}.md) | {page.splitlines()[2]} |")
    return "\n".join([*rows, "", "```{toctree}", ":hidden:", "", *(f"verbs/{verb}" for verb in verbs), "```"])


def stage(folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    known = pages()
    headers = cpp_pages.write(ROOT / "include", folder / "cpp", known)
    for path, name in known.items():
        text = (ROOT / path).read_text()
        if name == "index":
            others = other_pages(text, known)
            measured = [page for page in others if re.search(r"_(benchmarks|tables)$", page)]
            text = text.replace("<!-- other measurements -->", "\n".join(measured))
            text = text.replace("<!-- other pages -->", "\n".join(page for page in others if page not in measured))
            if not any(page.startswith("notebooks/") for page in known.values()):
                text = re.sub(r"```{toctree}\n:caption: Notebooks\n.*?```\n\n", "", text, flags=re.DOTALL)
        text = (notebook if path.endswith(".ipynb") else with_links)(text, path, known)
        if name == "verbs":
            text = text.replace("<!-- verbs -->", write_verbs(os.environ["STANDOFF"], folder / "verbs"))
        if name == "cpp":
            text = text.replace("<!-- headers -->", headers)
        target = folder / f"{name}{Path(path).suffix}"
        target.parent.mkdir(exist_ok=True)
        target.write_text(text)
    (folder / "parts").mkdir()
    for path in PARTS:
        (folder / "parts" / path.replace("/", "_")).write_text(with_links((ROOT / path).read_text(), path, known))
    for path in (ROOT / "docs").glob("*/*"):
        if path.suffix in (".png", ".svg", ".jpg", ".webp") and path.parent.name in ("images", "notebooks"):
            target = folder / path.relative_to(ROOT / "docs")
            target.parent.mkdir(exist_ok=True)
            shutil.copy2(path, target)


if __name__ == "__main__":
    stage(Path(sys.argv[1]))
