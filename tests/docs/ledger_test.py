# SPDX-License-Identifier: Apache-2.0
"""The ledger of docs/thesis.md: every algorithm, figure and table of the thesis has a row, every row a command or a reason, every
link leads somewhere, and every command is one that can be typed: its verb, options, scenes and names are known. Nothing is
computed."""

import os
import re
import shlex
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

SOURCE = Path(os.environ["STANDOFF_SOURCE_DIR"])
STANDOFF = os.environ["STANDOFF"]
PAGE = SOURCE / "docs/thesis.md"
NUMBERED = {"Algorithm": ["1", "2"], "Definition": ["4.1", "4.2"],
            "Figure": ["1.1", *(f"3.{n}" for n in range(1, 6)), *(f"4.{n}" for n in range(1, 7)), *(f"5.{n}" for n in range(1, 8))],
            "Table": ["3.1", "3.2", *(f"5.{n}" for n in range(1, 6))]}
WISHES = 6  # of chapter 7
# Options whose values are names that the help text lists.
NAMED = ("--method", "--mode", "--skip", "--device", "--sign", "--with")


@lru_cache(None)
def said(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=SOURCE)
    if done.returncode != 0:
        sys.exit(f"{shlex.join(command)}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


@lru_cache(None)
def options(verb):
    """{option: what the help says of it}, short names too."""
    found, names = {}, []
    for line in said(STANDOFF, verb, "--help").splitlines():
        if match := re.match(r"  (-\S+)(?: [A-Z0-9]\S*)?(?:  +|$)(.*)", line):
            names = match[1].split(",")
            found |= {name: match[2] for name in names}
        elif names and line.startswith(" " * 20):
            found |= {name: f"{found[name]} {line.strip()}" for name in names}
        else:
            names = []
    return found


def faults_of_standoff(words):
    verb, *rest = words
    if verb == "help":
        return
    if not re.search(rf"^  {verb} ", said(STANDOFF, "help"), re.M):
        yield f"no verb {verb}"
        return
    known = options(verb)
    for n, word in enumerate(rest):
        if word.startswith("-") and word not in known:
            yield f"{verb} has no option {word}"
        elif word in NAMED:
            value = re.match(r"\w+", rest[n + 1])[0]
            if not re.search(rf"\b{value}\b", known[word]):
                yield f"the help of {verb} {word} does not name {value}"
        elif word.startswith("scene:") and not re.search(rf"^{word[6:]} ", said(STANDOFF, "generate", "--list"), re.M):
            yield f"no {word}"


def faults_of_script(words):
    script, *rest = words
    if not (SOURCE / script).exists():
        yield f"no {script}"
        return
    text = (SOURCE / script).read_text()
    for word in rest:
        if script == "script/figures":
            if not re.search(rf"^def {word}\(", text, re.M) or not re.search(rf"^FIGURES = \[[^\]]*\b{word}\b", text, re.M):
                yield f"{script} has no figure {word}"
        elif script == "script/bench":
            if not re.search(rf"^  run\.py {word} ", (SOURCE / "bench/run.py").read_text(), re.M):
                yield f"{script} measures no {word}"
        elif not re.search(rf"(^|\W){re.escape(word)}\b", text):
            yield f"{script} does not know {word}"


def faults_of_command(command):
    words = shlex.split(command)
    if words[0] == "standoff":
        yield from faults_of_standoff(words[1:])
    elif words[0].startswith("script/"):
        yield from faults_of_script(words)
    else:
        yield f"`{command}` is no command of ours"


def anchors(page):
    """Of its headings, as the site and GitHub make them."""
    headings = re.findall(r"^#+ +(.*)", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def faults_of_link(target):
    path, _, anchor = target.partition("#")
    file = (PAGE.parent / path).resolve() if path else PAGE
    if not file.exists():
        yield f"links to {path}, which is not there"
    elif anchor and anchor not in anchors(file):
        yield f"links to {target}: the page has no such place"


def rows():
    section = re.search(r"^## The ledger\n(.*?)^## ", PAGE.read_text(), re.M | re.S)[1]
    table = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")]
    return table[2:]


def main():
    wrong, found = [], rows()
    for row in found:
        name = " ".join(row[:2])
        if len(row) != 4:
            wrong.append(f"{name}: {len(row)} cells, and not 4")
            continue
        where, what, command, result = row
        commands = re.findall(r"`([^`]+)`", command)
        if not where or not what:
            wrong.append(f"{name}: does not say what it is of")
        if bool(commands) == result.startswith("Left out: "):
            wrong.append(f"{name}: neither a command nor a reason, or both")
        wrong += [f"{name}: {fault}" for one in commands for fault in faults_of_command(one)]
        wrong += [f"{name}: {fault}" for target in re.findall(r"\]\(([^)\s]+)\)", result) for fault in faults_of_link(target)]
    first = [row[0] for row in found]
    wrong += [f"no row for {kind} {n}" for kind, numbers in NUMBERED.items() for n in numbers if f"{kind} {n}" not in first]
    if first.count("7, wish") != WISHES:
        wrong.append(f"{first.count('7, wish')} wishes of chapter 7, and not {WISHES}")
    if wrong:
        sys.exit(f"{PAGE}:\n" + "\n".join(wrong))
    print(f"{len(found)} rows")


main()
