# SPDX-License-Identifier: Apache-2.0
"""links.py FOLDER: every link and picture of the site leads to a file that is there, and every anchor to its place."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

ATTRIBUTES = {
    "a": "href",
    "link": "href",
    "img": "src",
    "script": "src",
    "source": "src",
    "iframe": "src",
    "object": "data",
}


class Page(HTMLParser):
    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[tuple[str, str, int]] = []
        self.anchors: set[str] = {"", "top"}
        self.nameless: list[int] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.anchors |= {values[key] for key in ("id", "name") if values.get(key)}
        line = self.getpos()[0]
        if (target := values.get(ATTRIBUTES.get(tag, ""))) is not None:
            self.links.append((tag, target, line))
        # What has no words gets its file's name from the builder.
        if tag == "img" and (values.get("alt") or "").strip() in ("", values.get("src")):
            self.nameless.append(line)


def main(folder: Path) -> None:
    pages = {path: Page(path) for path in sorted(folder.rglob("*.html"))}
    wrong, count = [], 0
    for path, page in pages.items():
        name = path.relative_to(folder)
        wrong += [f"{name}:{line}: a picture without words for those who do not see it (alt)" for line in page.nameless]
        for tag, target, line in page.links:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                if tag != "a":
                    wrong.append(f"{name}:{line}: <{tag}> is fetched from elsewhere: {target}")
                continue
            count += 1
            to = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if to.is_dir():
                to = to / "index.html"
            if not to.is_file():
                wrong.append(f"{name}:{line}: {target}: there is no such file")
            elif to in pages and unquote(parts.fragment) not in pages[to].anchors:
                wrong.append(f"{name}:{line}: {target}: the page has no such place")
    if wrong:
        sys.exit("\n".join(wrong))
    # Were links no longer found, none would be broken.
    if len(pages) < 60 or count < 20 * len(pages):
        sys.exit(f"only {count} links on {len(pages)} pages; are they still read as they are written?")
    print(f"{count:,} links on {len(pages)} pages lead somewhere")


main(Path(sys.argv[1]).resolve())
