# SPDX-License-Identifier: Apache-2.0
"""Reads the public headers: what each declares, and what its `///` comments say of it.

No C++ parser: it relies on how the headers are written (clang-format, a `///` comment before what it describes or a `///<`
comment behind it). tests/site/references.py checks that no comment and no name gets lost."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

_CLASS = re.compile(r"^(?:template\s*<.*?>\s*)?(struct|class|enum class|enum)\s+(?:STANDOFF_API\s+)?([\w:]+)")
_NAMESPACE = re.compile(r"^namespace\s+([\w:]+)")
# Members that every type has, and how types are walked through: noise in a reference.
_NOISE = re.compile(
    r"= default$|= delete$|^~|^explicit \w+\(std::shared_ptr|^friend |iterator|^static_assert|^using \w+::"
)


@dataclass
class Entity:
    """A declaration: its kind, its text without a body, its comment, and its members."""

    kind: str  # struct, class, enum, function, variable, type, macro
    name: str
    text: str
    comment: list[str]
    namespace: str = "standoff"
    members: list[Entity] = field(default_factory=list)


@dataclass
class Header:
    path: str
    purpose: list[str]
    entities: list[Entity]


def read_header(path: Path, include: Path) -> Header:
    lines = path.read_text().splitlines()
    purpose = []
    for line in lines[1:]:
        if not line.startswith("//"):
            break
        purpose.append(line[2:].removeprefix(" "))
    return Header(str(path.relative_to(include)), purpose, _Reader(lines).namespace_scope("", None))


class _Reader:
    """Goes through the lines of a header once, declaration by declaration."""

    def __init__(self, lines: list[str]) -> None:
        self.lines = lines
        self.at = 0

    def namespace_scope(self, namespace: str, end: int | None) -> list[Entity]:
        found: list[Entity] = []
        comment: list[str] = []
        while self.at < len(self.lines):
            line = self.lines[self.at].strip()
            if line.startswith("///"):
                comment.append(_comment_text(line))
            elif line.startswith("#define") and comment:
                found.append(Entity("macro", line.split()[1], line, comment))
                comment = []
            elif line.startswith("#"):  # what is defined under a condition is described before the condition
                pass
            elif line.startswith("//") or not line:
                comment = [] if not line else comment
            elif line.startswith("}"):
                self.at += 1
                return found
            elif match := _NAMESPACE.match(line):
                self.at += 1
                inner = self.namespace_scope(f"{namespace}::{match[1]}".lstrip(":"), None)
                if match[1] != "detail" and comment == []:
                    found += inner
                comment = []
                continue
            else:
                entity = self.declaration(comment, namespace)
                comment = []
                if entity is not None:
                    found.append(entity)
                continue
            self.at += 1
        return found

    def declaration(self, comment: list[str], namespace: str) -> Entity | None:
        """The declaration that begins on this line; its members too, if it is a type."""
        if (match := _CLASS.match(self.joined())) and (body := self.opens_body()):
            entity = Entity(match[1].split()[0], match[2], body, comment, namespace)
            entity.members = self.enumerators() if entity.kind == "enum" else self.members(entity, namespace)
            return entity
        text, behind = self.statement()
        comment = comment + behind
        # Declared only, or a member's definition: described elsewhere.
        if _CLASS.match(text) or (not comment and re.search(r" \w+::~?\w+\(", text)):
            return None
        return _simple(text, comment, namespace)

    def joined(self) -> str:
        return " ".join(line.strip() for line in self.lines[self.at : self.at + 3])

    def opens_body(self) -> str | None:
        """The head of a type, if its body follows; then the body is next."""
        head = []
        for n, line in enumerate(self.lines[self.at : self.at + 4]):
            head.append(line.strip())
            text = " ".join(head)
            if "{" in text:
                if text.count("{") == text.count("}"):  # a body on one line: put its parts on lines of their own
                    before, _, inside = text.partition("{")
                    inside = inside.rpartition("}")[0].rstrip()
                    parts = (
                        [f"  {part.strip()}," for part in inside.split(",")] if before.startswith("enum") else [inside]
                    )
                    self.lines[self.at : self.at + n + 1] = [before + "{", *parts, "};"]
                    return self.opens_body()
                self.at += n + 1
                return text.partition("{")[0].replace("STANDOFF_API ", "").strip()
            if ";" in text:
                return None
        return None

    def enumerators(self) -> list[Entity]:
        found: list[Entity] = []
        comment: list[str] = []
        while not (line := self.lines[self.at].strip()).startswith("}"):
            code, _, behind = line.partition("///<")
            if line.startswith("///<"):
                found[-1].comment.append(behind.strip())
            elif line.startswith("///"):
                comment.append(_comment_text(line))
            else:
                for part in filter(None, (piece.strip() for piece in code.split("//")[0].split(","))):
                    found.append(Entity("enumerator", part.split()[0], part, comment))
                    comment = []
                if behind and found:
                    found[-1].comment.append(behind.strip())
            self.at += 1
        self.at += 1
        return found

    def members(self, owner: Entity, namespace: str) -> list[Entity]:
        found: list[Entity] = []
        comment: list[str] = []
        public = owner.kind == "struct"
        while not (line := self.lines[self.at].strip()).startswith("}"):
            if line.startswith("///"):
                comment.append(_comment_text(line))
                self.at += 1
            elif re.match(r"(public|private|protected):", line):
                public = line.startswith("public")
                self.at += 1
            elif not line or line.startswith(("//", "#")):
                comment = [] if not line else comment
                self.at += 1
            else:
                entity = self.declaration(comment, namespace)
                if entity is not None and public and not (_NOISE.search(entity.text) and not entity.comment):
                    found.append(entity)
                comment = []
        # What stands behind the bracket, as in `struct Seconds { ... } seconds;`, is the next declaration.
        tail = self.lines[self.at].strip().removeprefix("}").strip(" ;")
        self.lines[self.at] = f"  {owner.name} {tail};" if tail else ""
        return found

    def statement(self) -> tuple[str, list[str]]:
        """A declaration's text up to its end, without its body; and the comment behind it."""
        text, behind, depth, braces, body = "", [], 0, 0, False
        while True:
            code, _, comment = self.lines[self.at].partition("///<")
            if comment:
                behind.append(comment.strip())
            code = code.split("//")[0]
            self.at += 1
            ended = False
            for c in code.strip():
                depth += (c == "(") - (c == ")")
                if c == "{" and depth == 0 and braces == 0:
                    body = body or (
                        "(" in text and not re.search(r"[^=!<>]=[^=]", re.sub(r"\(.*\)|operator=+", "", text))
                    )
                braces += (c == "{") - (c == "}") if depth == 0 or braces else 0
                if not (body and (braces or c == "}")):
                    text += c
                if braces == 0 and ((c == ";" and depth == 0) or (body and c == "}")):
                    ended = True
            text += " "
            if ended:
                break
        while self.at < len(self.lines) and self.lines[self.at].strip().startswith("///<"):
            behind.append(self.lines[self.at].strip()[4:].strip())
            self.at += 1
        return re.sub(r"\s+", " ", text).strip(" ;"), behind


def _comment_text(line: str) -> str:
    return line[3:].removeprefix(" ").rstrip()


def _simple(text: str, comment: list[str], namespace: str) -> Entity:
    text = text.replace("STANDOFF_API ", "")
    if alias := re.match(r"(template\s*<[^<>]*>\s*)?using (\w+)", text):
        return Entity("type", alias[2], text.replace("using ", "", 1), comment, namespace)
    text = re.sub(r"\[\] = \{.*\}$", "[]", text)  # the rows of a table are no part of what it looks like
    before = text.partition("=")[0] if "operator" not in text else text
    if "(" in before and not re.match(r"^(?:static |inline |constexpr )+[\w:]+ k[A-Z]", text):
        # A constructor's initialisers are no part of what it looks like.
        text = re.sub(r"\)\s*(?:noexcept\s*)?:\s*\w.*$", ")", text)
        name = re.search(
            r"(operator\s*\W+?|~?\w+)\s*\(", re.sub(r"^template\s*<.*?>\s*(requires\s*\(.*?\)\s+)?", "", text)
        )
        return Entity("function", name[1] if name else text, text, comment, namespace)
    name = re.search(r"(\w+)\s*(?:[={,]|$)", re.sub(r"<[^<>]*>", "", re.sub(r"<[^<>]*>", "", text)))
    return Entity("variable", name[1] if name else text, text, comment, namespace)
