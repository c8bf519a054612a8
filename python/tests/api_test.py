# SPDX-License-Identifier: Apache-2.0
"""The public names and their signatures are those of api.txt.

A change of the interface is a change of api.txt: ``python python/tests/api_test.py`` rewrites it.
"""

import dataclasses
import inspect
from pathlib import Path

import standoff as so

GOLDEN = Path(__file__).with_name("api.txt")
SPECIAL = (
    "__array__",
    "__bytes__",
    "__call__",
    "__cuda_array_interface__",
    "__dlpack__",
    "__dlpack_device__",
    "__len__",
)


class Plain(str):
    """An annotation as it stands in the source."""

    __repr__ = str.__str__


def signature(thing):
    found = inspect.signature(thing)
    parameters = [p.replace(annotation=plain(p.annotation)) for p in found.parameters.values()]
    return str(found.replace(parameters=parameters, return_annotation=plain(found.return_annotation)))


def plain(annotation):
    return Plain(annotation) if isinstance(annotation, str) else annotation


def lines():
    for name in sorted(so.__all__):
        thing = getattr(so, name)
        if inspect.isfunction(thing):
            yield f"{name}{signature(thing)}"
        elif inspect.isclass(thing):
            bases = ", ".join(base.__name__ for base in thing.__bases__ if base is not object)
            yield f"class {name}({bases})" if issubclass(thing, BaseException) else f"class {name}{signature(thing)}"
            if dataclasses.is_dataclass(thing):
                yield from (f"    {name}.{field.name}: {field.type}" for field in dataclasses.fields(thing))
            for member, value in sorted(vars(thing).items()):
                if member.startswith("_") and member not in SPECIAL:
                    continue
                if isinstance(value, (classmethod, staticmethod)):
                    yield f"    {name}.{member}{signature(value.__func__)}  # {type(value).__name__}"
                elif inspect.isfunction(value):
                    yield f"    {name}.{member}{signature(value)}"
                elif isinstance(value, property):
                    yield f"    {name}.{member} -> {inspect.signature(value.fget).return_annotation}"
        else:
            yield f"{name}: {type(thing).__name__}"


def test_the_interface_is_the_golden_one():
    assert "\n".join(lines()).splitlines() == GOLDEN.read_text(encoding="utf-8").splitlines()


def test_all_is_complete():
    modules = {name for name, value in vars(so).items() if inspect.ismodule(value)}
    public = {name for name in vars(so) if not name.startswith("_")} - modules
    assert public | {"__version__"} == set(so.__all__)


if __name__ == "__main__":
    GOLDEN.write_text("\n".join(lines()) + "\n", encoding="utf-8")
