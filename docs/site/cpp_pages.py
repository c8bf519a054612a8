# SPDX-License-Identifier: Apache-2.0
"""The reference of the C++ API: a page for each public header, written in reStructuredText from what headers.py reads."""

from __future__ import annotations

import re
from pathlib import Path

from headers import Entity, Header, read_header

# The headers by what they are for. Those that are not named stand under the last heading, by name.
TASKS = {
    "Meshes": ["mesh", "mesh_view", "io", "mesh_report"],
    "Fields": ["grid", "compute", "field", "sign", "verify", "inspect"],
    "Fields beyond one call": ["slabs", "windows", "zarr", "field_slices", "slice_reader", "sign_decision", "field_cache", "update"],
    "Points without a grid": ["points"],
    "Surfaces, voxels and more than distances": ["surface", "sidecars", "feature", "crossings", "voxels", "occupancy", "confidence", "exposed"],
    "Bodies and collision": ["collision", "pose"],
    "Pictures and pages": ["slice", "picture", "page", "colormap", "color", "axis"],
    "On a GPU": ["cuda_compute", "cuda", "cuda_batch"],
    "Where and how work runs": ["execution", "memory", "progress", "error", "existing", "vec", "version"],
    "More": [],
}  # fmt: skip


def write(include: Path, folder: Path, pages: dict[str, str]) -> str:
    """Writes the pages into the folder; returns what leads to them, by task, in Markdown. `pages` has the site's pages by their
    path in the repository."""
    headers = [read_header(path, include) for path in sorted((include / "standoff").glob("*.h"))]
    folder.mkdir(parents=True)
    # What a comment may name -> what it becomes.
    targets = {path: f"\\ :doc:`/{name}`" for path, name in pages.items()}
    targets |= {h.path: f"\\ :doc:`/cpp/{Path(h.path).stem}`" for h in headers if h.entities}
    for header in headers:
        for entity in header.entities:
            targets |= _names(entity)
    made = {Path(header.path).stem: header for header in headers if header.entities}
    for name, header in made.items():
        (folder / f"{name}.rst").write_text(_page(header, targets))
    return _by_task(made)


def _by_task(headers: dict[str, Header]) -> str:
    """A table for each task, and the headers in that order for the sidebar."""
    named = {name for names in TASKS.values() for name in names}
    rest = {"More": [name for name in headers if name not in named]}
    out, order = [], []
    for task, names in (TASKS | rest).items():
        present = [name for name in names if name in headers]
        if present:
            out += [f"## {task}", "", "| header | what it has |", "|---|---|"]
            out += [f"| [{name}](cpp/{name}.rst) | {_first_sentence(headers[name])} |" for name in present] + [""]
        order += present
    return "\n".join([*out, "```{toctree}", ":hidden:", "", *(f"cpp/{name}" for name in order), "```"])


def _first_sentence(header: Header) -> str:
    """Without the page that it may name in parentheses."""
    text = " ".join(" ".join(header.purpose).split())
    sentence = re.match(r".*?[^.]\.(?= |$)", text)
    return re.sub(r" \(docs/[^)]*\)", "", sentence[0] if sentence else text)


def _names(entity: Entity) -> dict[str, str]:
    """How comments write the name of a function, a type, or a type's member; of types of one word only with a member."""
    if entity.namespace != "standoff" or not re.fullmatch(r"\w+", entity.name):
        return {}
    if entity.kind == "function":
        return {f"{entity.name}()": f"\\ :cpp:any:`{entity.name}() <standoff::{entity.name}>`\\ "}
    if entity.kind not in ("struct", "class", "enum"):
        return {}
    found = {
        f"{entity.name}::{m.name}": f"\\ :cpp:any:`{entity.name}::{m.name} <standoff::{entity.name}::{m.name}>`\\ "
        for m in entity.members
    }
    if re.search(r"[a-z][A-Z]", entity.name):
        found[entity.name] = f"\\ :cpp:any:`{entity.name} <standoff::{entity.name}>`\\ "
    return found


def _page(header: Header, targets: dict[str, str]) -> str:
    out = [header.path, "=" * len(header.path), "", *_prose(header.purpose, targets), ".. code-block:: cpp", ""]
    out += [f"   #include <{header.path}>", ""]
    namespace = None
    for entity in header.entities:
        if entity.namespace != namespace and entity.kind != "macro":
            namespace = entity.namespace
            out += [f".. cpp:namespace:: {namespace}", ""]
        out += _entity(entity, targets)
    return "\n".join(out) + "\n"


def _entity(entity: Entity, targets: dict[str, str]) -> list[str]:
    directive = {"function": "cpp:function", "variable": "cpp:var", "type": "cpp:type", "macro": "c:macro"}
    if entity.kind in ("struct", "class"):
        name = re.sub(r"^(.*)\b(struct|class) ", r"\1", entity.text)
        head = [f".. cpp:{entity.kind}:: {name}"]
    elif entity.kind == "enum":
        scoped = "enum-class" if entity.text.startswith("enum class") else "enum"
        head = [f".. cpp:{scoped}:: {re.sub(r'^enum (class )?', '', entity.text)}"]
    elif entity.kind == "enumerator":
        head = [f".. cpp:enumerator:: {entity.text}"]
    elif entity.kind == "macro":
        head = [f".. c:macro:: {entity.name}"]
    else:
        signatures = [entity.text] if entity.kind != "variable" else _declarators(entity.text)
        lead = f".. {directive[entity.kind]}:: "
        head = [lead + signatures[0], *(" " * len(lead) + more for more in signatures[1:])]
    inside = _prose(entity.comment, targets)
    for member in entity.members:
        inside += _entity(member, targets)
    return [*head, "", *("   " + line if line else "" for line in inside), ""]


def _declarators(text: str) -> list[str]:
    """`double x = 0, y = 0` as one declaration for each name."""
    parts, depth, start = [], 0, 0
    for at, c in enumerate(text):
        depth += (c in "({<[") - (c in ")}>]")
        if c == "," and depth == 0:
            parts.append(text[start:at].strip())
            start = at + 1
    parts.append(text[start:].strip())
    if len(parts) == 1:
        return parts
    kind = re.match(r"(.*?)\s*\w+\s*(=.*)?$", parts[0])[1]
    return [parts[0], *(f"{kind} {part}" for part in parts[1:])]


def _prose(comment: list[str], targets: dict[str, str]) -> list[str]:
    """A comment's lines: paragraphs, indented code, `names`, and links to the pages that it names."""
    out, code, paragraph = [], [], []

    def close() -> None:
        if code:
            out.extend([".. code-block:: cpp", "", *code, ""])
            code.clear()
        if paragraph:
            text = " ".join(paragraph)
            # What a function throws is a paragraph of its own.
            for part in re.split(r"(?<=[.;:)]) (?=Errors(?: of all queries)?: )", text):
                out.extend([_inline(re.sub(r"^(Errors[^:]*:)", r"**\1**", part), targets), ""])
            paragraph.clear()

    for line in comment:
        if line.startswith("    ") and not paragraph:
            code.append("   " + line.strip())
        elif not line.strip():
            close()
        else:
            paragraph.append(line.strip())
    close()
    return out


def _inline(text: str, targets: dict[str, str]) -> str:
    def piece(part: str) -> str:
        if part.startswith("`"):
            return f"``{part.strip('`')}``"
        if part.startswith("**"):
            return part
        if part in targets:
            return targets[part]
        return re.sub(r"([*_|\\<>])", r"\\\1", part)

    known = "|".join(re.escape(path) for path in sorted(targets, key=len, reverse=True))
    parts = re.split(rf"(``?[^`]+``?|\*\*Errors[^*]*\*\*|(?<![\w/.:])(?:{known})(?![\w/:(]))", text)
    return "".join(piece(part) for part in parts if part)
