# SPDX-License-Identifier: Apache-2.0
"""Files of many meshes: the program's batch, from Python."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any, Literal

from ._checks import PathLike, flag, number, runs_on, whole_number
from ._errors import make
from ._options import Sign, memory_limit_of
from ._program import PROGRAM

if TYPE_CHECKING:
    import subprocess


@dataclass(frozen=True)
class BatchResult:
    """What a batch has left in its folder."""

    folder: str
    """Where results and manifest are."""
    manifest: str
    """The path of the manifest: a line of JSON for each mesh (docs/batch_files.md, "Rows")."""
    summary: dict[str, Any]
    """What this run did: ``counts`` of the rows that it wrote by status, ``skipped`` meshes of earlier runs, ``seconds``."""

    def rows(self) -> Iterator[dict[str, Any]]:
        """The last row of each mesh of this run and of earlier ones, in the order of the list. Holds all of them."""
        import json

        last: dict[int, dict[str, Any]] = {}
        with open(self.manifest, encoding="utf-8") as lines:
            for line in lines:
                if line.endswith("\n"):
                    row = json.loads(line)
                    last[row["index"]] = row
        for index in sorted(last):
            yield last[index]

    def failures(self) -> list[dict[str, Any]]:
        """The rows of meshes that have no result: ``status`` and ``message`` say why."""
        return [row for row in self.rows() if row["code"] != 0]


def batch(
    meshes: PathLike | Iterable[PathLike],
    out: PathLike,
    *,
    resolution: int | None = None,
    spacing: float | Sequence[float] | None = None,
    shape: Sequence[int] | None = None,
    padding: float | None = None,
    band: float | None = None,
    thickness: float | None = None,
    sign: str | Sign | None = "auto",
    normalize: Literal["none", "unit-cube", "unit-sphere"] = "none",
    format: str = "npz",
    points: int | None = None,
    near: float | None = None,
    sigma: Sequence[float] | None = None,
    seed: int | None = None,
    shard: tuple[int, int] | None = None,
    resume: bool = False,
    timeout: float | None = None,
    cache: PathLike | None = None,
    device: str = "auto",
    threads: int = 0,
    memory_limit: int | None = None,
) -> BatchResult:
    """Writes the fields of many mesh files, or points with distances, by processes of the program ``standoff batch``.

    A mesh that cannot be read, takes too long or ends its process costs only itself; a run that was stopped goes on with
    ``resume=True``. For fields in memory there is `fields`.

    Args:
        meshes: a folder, a file with a path on each line, or paths in any iterable, also a long one: it is read as
            meshes are worked on.
        out: the folder of results and manifest.
        resolution, spacing, shape, padding, band, thickness: as for `field`.
        sign: as for `field`.
        normalize: ``"unit-cube"`` moves each mesh's box to the origin and scales its longest side to 1; ``"unit-sphere"``
            scales the farthest corner's distance to 1.
        format: of the fields' files, an extension of `DistanceField.save`; or ``"array"``: one Zarr array of all fields,
            ``out/fields.zarr``, a row for each mesh (docs/batch_files.md). It takes `shape`.
        points: write so many points with exact distances in place of fields: training data.
        near: the share of points near the surface, by default 0.8; the others are uniform in the grid's box.
        sigma: two deviations of the offsets from the surface, as shares of the box's longest side.
        seed: other points for other numbers.
        shard: ``(part, of)``: only every ``of``-th mesh from the ``part``-th on, 1 to ``of``.
        resume: leave out meshes that are done and have not changed. Without it the folder must have no manifest.
        timeout: seconds that a mesh may take.
        cache: a folder, which many may share, of fields that were computed before: those are not computed again.
        device, threads, memory_limit: as for `field`; so many meshes are worked on side by side.

    Raises:
        InputError: there is no mesh in the list. Meshes that cannot be used are rows (`BatchResult.failures`).
        OutputError: the folder or the manifest cannot be written.
        UsageError, ValueError, TypeError: arguments.
        KeyboardInterrupt: Ctrl-C; what is done is kept.

    Example:
        >>> result = standoff.batch("meshes", "fields", resolution=64, band=3)       # doctest: +SKIP
        >>> for row in result.failures():                                            # doctest: +SKIP
        ...     print(row["path"], row["message"])
    """
    if not os.path.exists(PROGRAM):
        raise FileNotFoundError(f"{PROGRAM}: the program is missing from this package; install the package anew")
    if band is not None and thickness is not None:
        raise ValueError("band and thickness: give one of these; band counts in samples, thickness in world units")
    asked = Sign.of(sign)
    limit = memory_limit_of(memory_limit)
    count, where = runs_on(threads, device)
    values: dict[str, Any] = {
        "--resolution": None if resolution is None else whole_number(resolution, "resolution"),
        "--spacing": _joined(spacing, "spacing"),
        "--size": _joined(shape, "shape", whole=True),
        "--padding": None if padding is None else repr(number(padding, "padding")),
        "--thickness": _thickness(band, thickness),
        "--sign": f"shell:{number(asked.shell, 'shell')!r}" if asked.method == "shell" else asked.method,
        "--rule": asked.rule,
        "--normalize": normalize,
        "--format": None if points is not None and format == "npz" else format,
        "--points": None if points is None else whole_number(points, "points"),
        "--near": None if near is None else repr(number(near, "near")),
        "--sigma": _joined(sigma, "sigma"),
        "--seed": None if seed is None else whole_number(seed, "seed"),
        "--shard": None if shard is None else "{}/{}".format(*(whole_number(n, "shard") for n in shard)),
        "--timeout": None if timeout is None else repr(number(timeout, "timeout")),
        "--cache": None if cache is None else os.fspath(cache),
        "--device": where,
        "--threads": count or None,
        "--memory-limit": None if limit == 0 else "none" if limit < 0 else limit,
    }
    flags = {
        "--invert": asked.invert,
        "--strict": asked.strict,
        "--as-oriented": asked.as_oriented,
        "--outer": asked.outer,
        "--resume": flag(resume, "resume"),
    }
    options = [f"{name}={value}" for name, value in values.items() if value is not None]
    options += [name for name, given in flags.items() if given]
    return _run(meshes, os.fspath(out), options, shard)


def merged(folder: str) -> BatchResult:
    """Joins the manifests of all parts in a folder."""
    import json
    import subprocess

    done = subprocess.run(
        [PROGRAM, "batch", "--merge", "-o", folder, "--quiet", "--json"], capture_output=True, text=True, check=False
    )
    if not done.stdout or done.returncode not in (0, 3):
        raise make(
            _NAMES.get(done.returncode, "internal"),
            done.stderr.rpartition("standoff: error: ")[2].strip() or f"exit code {done.returncode}",
        )
    return BatchResult(folder, os.path.join(folder, "manifest.jsonl"), json.loads(done.stdout))


def _joined(values: Any, what: str, *, whole: bool = False) -> str | None:
    if values is None:
        return None
    several = [values] if not isinstance(values, Iterable) or getattr(values, "ndim", 1) == 0 else list(values)
    return ",".join(str(whole_number(v, what)) if whole else repr(number(v, what)) for v in several)


def _thickness(band: float | None, thickness: float | None) -> str | None:
    if band is not None:
        return f"{number(band, 'band')!r}s"
    return None if thickness is None else repr(number(thickness, "thickness"))


def _run(
    meshes: PathLike | Iterable[PathLike], folder: str, options: list[str], shard: tuple[int, int] | None
) -> BatchResult:
    import json
    import subprocess
    import tempfile

    command = [PROGRAM, "batch", "-o", folder, "--quiet", "--json", *options]
    single = isinstance(meshes, (str, os.PathLike))
    command += ["--", os.fspath(meshes)] if single else ["--null", "--", "-"]  # type: ignore[arg-type]
    # Files, not pipes: nobody reads while the list is written.
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as messages:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL if single else subprocess.PIPE, stdout=said, stderr=messages
        )
        try:
            if not single:
                _feed(process, meshes)  # type: ignore[arg-type]
            code = process.wait()
        except BaseException:
            process.terminate()
            process.wait()
            raise
        output, errors = _text(said), _text(messages)
    if not output or code not in (0, 3):  # 3 with an answer: some meshes have failed
        raise make(
            _NAMES.get(code, "internal"), errors.rpartition("standoff: error: ")[2].strip() or f"exit code {code}"
        )
    part = "" if shard is None or shard[1] == 1 else "-{}-of-{}".format(*shard)
    return BatchResult(folder, os.path.join(folder, f"manifest{part}.jsonl"), json.loads(output))


# The exit codes of the program.
_NAMES = {2: "usage", 3: "input", 4: "output", 5: "limit", 6: "device", 8: "doubt", 130: "interrupted"}


def _feed(process: subprocess.Popen[bytes], meshes: Iterable[PathLike]) -> None:
    assert process.stdin is not None
    try:
        with process.stdin as pipe:
            for mesh in meshes:
                pipe.write(os.fsencode(mesh) + b"\0")
                pipe.flush()
    except BrokenPipeError:
        pass  # it has ended, and says why


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode(errors="replace")
