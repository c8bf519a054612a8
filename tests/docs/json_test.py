# SPDX-License-Identifier: Apache-2.0
"""docs/json.md against the program: each section's commands are run, and the objects that they print held against its table.

Every key that is printed stands in the table, with a type that fits; every row of the table is printed by one command at
least, and by each one where its column `when` is empty."""
import json
import os
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(os.environ["STANDOFF_SOURCE_DIR"]) / "docs" / "json.md"
BUILD = pathlib.Path(os.environ["STANDOFF"]).parent
MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
# No test machine shows them all.
NOT_HERE = ("with a GPU", "without a GPU")


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_integer(value):
    return isinstance(value, int) and not isinstance(value, bool)


def is_list(value, length, is_element):
    return isinstance(value, list) and len(value) == length and all(map(is_element, value))


def is_object(value, **keys):
    return isinstance(value, dict) and value.keys() == keys.keys() and all(fits(value[key], keys[key]) for key in keys)


TYPES = {
    "null": lambda value: value is None,
    "string": lambda value: isinstance(value, str),
    "array of strings": lambda value: isinstance(value, list) and all(isinstance(one, str) for one in value),
    "boolean": lambda value: isinstance(value, bool),
    "integer": is_integer,
    "number": is_number,
    "point": lambda value: is_list(value, 3, is_number),
    "size": lambda value: is_list(value, 3, is_integer),
    "box": lambda value: is_list(value, 2, TYPES["point"]),
    "grid": lambda value: is_object(value, size="size", origin="point", spacing="point"),
    "object": lambda value: isinstance(value, dict),
    "output": lambda value: is_object(value, file="string", bytes="integer"),
    "check": lambda value: is_object(value, sample="size", position="point", stored="number or null",
                                     expected="number or null", error="number or null", allowed="number or null"),
}


def fits(value, kind):
    return any(TYPES[one](value) for one in kind.split(" or "))


def rows(text):
    """{key: (type, when)} of the section's table."""
    found = {}
    for line in re.findall(r"^\| `.*\|$", text, re.M):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        when = cells[2] if len(cells) == 4 else ""
        found[cells[0].strip("`")] = (cells[1], when)
    return found


def leaves(value, table, path=""):
    """(path, value) of what the table has rows for, and of everything else down to the last key."""
    if path in table or not isinstance(value, (dict, list)):
        yield path, value
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, table, f"{path}.{key}" if path else key)
    elif all(isinstance(inner, dict) for inner in value):
        for inner in value:
            yield from leaves(inner, table, path + "[]")
    else:
        yield path, value


def run(command):
    done = subprocess.run(["bash", "-c", command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, "PATH": f"{BUILD}:{os.environ['PATH']}"})
    if done.returncode != 0:
        sys.exit(f"{command}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def faults(section, table, commands):
    seen = {}
    for command in commands:
        printed = dict_of_lists(leaves(json.loads(run(command)), table))
        for key, values in printed.items():
            if key not in table:
                yield f"{command}: prints {key}, which is not in the table of {section}"
            elif not all(fits(value, table[key][0]) for value in values):
                yield f"{command}: {key} is {values}, and no {table[key][0]}"
        for key, (_, when) in table.items():
            if when == "" and key not in printed:
                yield f"{command}: lacks {key}"
            seen[key] = seen.get(key, False) or key in printed
    for key, (_, when) in table.items():
        if not seen.get(key) and when not in NOT_HERE:
            yield f"{section}: no command prints {key}"


def dict_of_lists(pairs):
    found = {}
    for key, value in pairs:
        found.setdefault(key, []).append(value)
    return found


def main():
    pathlib.Path("bunny.obj").write_text(MESH)
    head, *sections = re.split(r"^## ", PAGE.read_text(), flags=re.M)
    common = {key: row for key, row in rows(head).items() if key in ("schema", "version", "verb")}
    wrong, verbs = [], set()
    for text in sections:
        section = text.splitlines()[0]
        lines = re.search(r"^```sh\n(.*?)^```$", text, re.M | re.S)[1].splitlines()
        commands = []
        for line in lines:
            if "--json" in line:
                commands.append(line)
                verbs.add(line.split()[1])
            else:
                # Preparation for what follows: at once, so that its files are there.
                run(line)
        wrong += faults(section, {**common, **rows(text)}, commands)
    takes_json = {verb for verb in re.findall(r"^  (\w+) ", run("standoff help").split("Verbs:")[1], re.M)
                  if "--json" in run(f"standoff help {verb}")}
    wrong += [f"{verb}: no section runs it with --json" for verb in sorted(takes_json - verbs)]
    if len(common) != 3 or len(takes_json) < 10:
        wrong.append(f"{PAGE}: its tables are not found as they were")
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"{len(sections)} sections agree with the program")


main()
