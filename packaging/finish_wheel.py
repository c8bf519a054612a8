#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""finish_wheel.py WHEEL: puts the licences of all that the wheel holds besides standoff into it.

auditwheel notes the Debian packages of the libraries that it copied into the wheel in a bill of materials there. To these
come the libraries that are compiled into the program and the module. The wheel is written again, compressed as far as
deflate goes, with the same bytes for the same contents.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import sys
import urllib.parse
import zipfile
from importlib import metadata
from pathlib import Path

# Debian packages of headers that the program is compiled with.
COMPILED_IN = ["libcli11-dev", "libtbb-dev", "nlohmann-json3-dev"]
# Where the wheel holds GPU code and the toolkit has no text of its licence beside it.
CUDA_WORDS = b"""The GPU code of this package is linked with the CUDA runtime (libcudart_static). NVIDIA's End User
License Agreement for the CUDA Toolkit allows to distribute it with an application (Attachment A).
"""


def debian_licence(package: str) -> bytes:
    path = Path("/usr/share/doc") / package / "copyright"
    if not path.is_file():
        sys.exit(f"finish_wheel.py: {path} is missing; a wheel must hold the licence of what it copies")
    text = path.read_text(encoding="utf-8")
    return (part_of_boost(text) if package.startswith("libboost-context") else text).encode()


def part_of_boost(text: str) -> str:
    """The paragraphs on Boost.Context alone of Debian's 2 MB on all of Boost."""
    head, *paragraphs = text.split("\n\n")
    files = [p for p in paragraphs if p.startswith("Files:") and re.search(r"^Files:\s*(\*|libs/context/\*)$", p, re.MULTILINE)]
    names = set(re.findall(r"^License: *(\S+)", "\n".join(files), re.MULTILINE))
    full = [p for p in paragraphs if re.match(r"License: *(\S+)", p) and p.split()[1] in names]
    if not files or len(full) < len(names):
        sys.exit("finish_wheel.py: Debian's copyright file of Boost has another form now; see part_of_boost")
    return "\n\n".join([head, *files, *full]) + "\n"


def vendored(files: dict[str, bytes]) -> list[str]:
    """The Debian packages of the libraries that auditwheel copied; an error if it does not know one of them."""
    libraries = [name for name in files if ".libs/" in name]
    boms = [json.loads(data) for name, data in files.items() if name.endswith("auditwheel.cdx.json")]
    urls = {part["purl"] for bom in boms for part in bom["components"]}
    packages = [urllib.parse.unquote(url.split("/")[-1].split("@")[0]) for url in urls if url.startswith("pkg:deb/")]
    if len(packages) < len(libraries):
        sys.exit(f"finish_wheel.py: {len(libraries)} libraries were copied, of {packages} only; the others' licences?")
    return sorted(packages)


def licences(files: dict[str, bytes]) -> dict[str, bytes]:
    """The name of each part, and its licence."""
    found = {package: debian_licence(package) for package in sorted({*vendored(files), *COMPILED_IN})}
    found["nanobind"] = next(f for f in metadata.files("nanobind") or [] if f.name == "LICENSE").read_binary()
    if any(b".nv_fatbin" in data for data in files.values()):
        home = Path(os.environ.get("CUDA_HOME", "/usr/local/cuda"))
        texts = [home / "EULA.txt", *home.glob("dist-info/nvidia_cuda_runtime-*/licenses/License.txt")]
        text = next((path for path in texts if path.is_file()), None)
        found["cuda-runtime"] = text.read_bytes() if text else CUDA_WORDS
    return found


def record(files: dict[str, bytes], name: str) -> bytes:
    rows = []
    for file, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        rows.append(f"{file},sha256={digest},{len(data)}\n")
    return "".join([*rows, f"{name},,\n"]).encode()


def finish(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        entries = [entry for entry in archive.infolist() if not entry.is_dir()]
        files = {entry.filename: archive.read(entry) for entry in entries}
        modes = {entry.filename: entry.external_attr for entry in entries}
    info = next(name for name in files if name.endswith(".dist-info/METADATA")).rsplit("/", 1)[0]
    texts = {f"{package}.txt": text for package, text in licences(files).items()}
    for name, text in texts.items():
        files[f"{info}/licenses/{name}"] = text
    head, empty_line, body = files[f"{info}/METADATA"].partition(b"\n\n")
    named = "".join(f"\nLicense-File: {name}" for name in texts if f"License-File: {name}\n".encode() not in head)
    files[f"{info}/METADATA"] = head + named.encode() + empty_line + body
    files.pop(f"{info}/RECORD")
    files[f"{info}/RECORD"] = record(files, f"{info}/RECORD")  # last, as the format of wheels asks for
    beside = wheel.with_suffix(".tmp")
    with zipfile.ZipFile(beside, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = modes.get(name, 0o644 << 16)
            archive.writestr(entry, data)
    beside.replace(wheel)
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, with the licences of {', '.join(sorted(texts))}")


if __name__ == "__main__":
    finish(Path(sys.argv[1]))
