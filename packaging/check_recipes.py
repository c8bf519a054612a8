# SPDX-License-Identifier: Apache-2.0
"""Checks that the recipes for conda and vcpkg are of their forms, and speak of the standoff beside them."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import rattler_build

ROOT = Path(__file__).resolve().parent.parent
VERSION = re.search(r'STANDOFF_VERSION "([^"]+)"', (ROOT / "include/standoff/version.h").read_text())[1]
OPTIONS = set(re.findall(r"(?:option|set)\((STANDOFF_\w+)", (ROOT / "cmake/options.cmake").read_text()))
OPTIONS |= set(re.findall(r"option\((STANDOFF_\w+)", (ROOT / "python/CMakeLists.txt").read_text()))
faults = []


def expect(right: object, fault: str) -> None:
    if not right:
        faults.append(fault)


def check_options(name: str) -> None:
    """Every option of ours that a recipe sets is one: CMake itself would only warn."""
    used = set(re.findall(r"\bSTANDOFF_(?!PATH)[A-Z_]+", (ROOT / name).read_text()))
    expect(used <= OPTIONS, f"{name}: there is no option {', '.join(used - OPTIONS)}; see cmake/options.cmake")


def check_conda() -> None:
    name = "packaging/conda/recipe.yaml"
    check_options(name)
    config = rattler_build.RenderConfig(rattler_build.PlatformConfig(target_platform="linux-64"))
    variants = rattler_build.VariantConfig.from_yaml(
        "python: ['3.10.* *_cpython', '3.13.* *_cp313']\nc_stdlib: [sysroot]\n"
    )
    rendered = rattler_build.Stage0Recipe.from_file(ROOT / name).render(variants, config)
    recipes = [variant.recipe.to_dict() for variant in rendered]
    found = sorted((recipe["package"]["name"], recipe["package"]["version"]) for recipe in recipes)
    expect({package for package, _ in found} == {"libstandoff", "standoff"}, f"{name}: renders to {found}")
    expect({version for _, version in found} == {VERSION}, f"{name}: its version is not {VERSION}")
    text = (ROOT / name).read_text()
    wanted = re.search(r"^dependencies = \[(.*)\]", (ROOT / "pyproject.toml").read_text(), re.MULTILINE)[1]
    wanted += re.search(r"^requires = \[(.*)\]", (ROOT / "pyproject.toml").read_text(), re.MULTILINE)[1]
    for package, bounds in re.findall(r'"([\w-]+)([^"]*)"', wanted):
        expect(f"- {package} {bounds}" in text, f"{name}: pyproject.toml wants {package}{bounds}, and it does not")
    print(f"conda: renders to {len(found)} packages: {found}")


def check_vcpkg() -> None:
    name = "packaging/vcpkg/vcpkg.json"
    manifest = json.loads((ROOT / name).read_text())
    expect(manifest["version"] == VERSION, f"{name}: its version is not {VERSION}")
    expect(set(manifest["default-features"]) <= set(manifest["features"]), f"{name}: a default feature is none")
    expect(manifest["license"] == "Apache-2.0", f"{name}: another licence")
    check_options("packaging/vcpkg/portfile.cmake")
    print(f"vcpkg: version {VERSION}, features {', '.join(manifest['features'])}")


check_conda()
check_vcpkg()
sys.exit("\n".join(faults) or 0)
