# SPDX-License-Identifier: Apache-2.0
"""Fields by Dask: lazy arrays, and stores that a cluster writes, whatever happens to its workers."""

import contextlib
import inspect
import os
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
import urllib.request
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import shapes
import standoff as so

pytest.importorskip("distributed", reason="the extra standoff[dask] is not installed")
import dask
import standoff.dask as sd
import zarr
from distributed import Client, LocalCluster
from standoff.dask._compute import METHODS_IN_WINDOWS, SIGNS_IN_WINDOWS
from standoff.dask._write import tasks_of

MESH = shapes.sphere(8)
SIZES = {"resolution": 120, "band": 3}
LAYOUT = {"shard": 32, "chunk": 16}


@pytest.fixture
def client():
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as connected,
    ):
        yield connected


@pytest.fixture(scope="module")
def serial(tmp_path_factory):
    """The store that this process writes."""
    path = tmp_path_factory.mktemp("serial") / "field.zarr"
    sd.write(path, MESH, **SIZES, **LAYOUT)
    return path


def content(store):
    return {path.relative_to(store).as_posix(): path.read_bytes() for path in Path(store).rglob("*") if path.is_file()}


def expect_same(store, other):
    mine, theirs = content(store), content(other)
    assert mine.keys() == theirs.keys()
    assert [name for name in mine if mine[name] != theirs[name]] == []


@pytest.mark.parametrize("sign", ["auto", "flood", None])
def test_lazy_arrays_are_the_field(sign, client):
    whole = so.field(MESH, sign=sign, **SIZES)
    lazy = sd.compute(MESH, window=(32, 48, 64), sign=sign, **SIZES)
    assert lazy.shape == whole.shape and lazy.dtype == np.float32
    np.testing.assert_array_equal(np.asarray(lazy.compute()).view(np.uint32), whole.numpy().view(np.uint32))
    part = lazy[40:70, 1, 60:].compute()
    np.testing.assert_array_equal(part, whole.numpy()[40:70, 1, 60:])
    with dask.config.set(scheduler="synchronous"):
        np.testing.assert_array_equal(lazy[:33, :33, :33].compute(), whole.numpy()[:33, :33, :33])


def test_the_mesh_is_one_node_of_the_graph():
    lazy = sd.compute(shapes.sphere(100), window=64, resolution=512, band=2)
    graph = lazy.__dask_graph__()
    assert sum("standoff-mesh" in str(key) for key in graph) == 1


# A mesh whose sign takes a diagnosis: open, with faces turned.
def mended():
    vertices, faces = shapes.sphere(8)
    faces = np.delete(faces, range(30, 40), axis=0)
    faces[::3] = faces[::3, ::-1]
    return vertices, faces


# What decides is replaced in the workers: they must get the decision, and it must be the one that was made.
COUNTS_DECISIONS = """
    import os
    from pathlib import Path
    from standoff.dask._job import Job

    def prepare(self, threads, prepare=Job.prepare):
        if self.decision is None:
            Path(os.environ["STANDOFF_TEST_DECIDED"], f"{os.getpid()}").touch()
        return prepare(self, threads)

    if Job.prepare.__module__ == "standoff.dask._job":  # a worker loads this twice
        Job.prepare = prepare
"""


@pytest.mark.filterwarnings("ignore::standoff.SignWarning")
def test_the_sign_is_decided_once(tmp_path, monkeypatch):
    (tmp_path / "counts.py").write_text(textwrap.dedent(COUNTS_DECISIONS))
    decided = tmp_path / "decided"
    decided.mkdir()
    monkeypatch.setenv("STANDOFF_TEST_DECIDED", str(decided))
    whole = so.field(mended(), **SIZES)
    assert whole.sign.flipped > 0
    with (
        dask.config.set({"distributed.worker.preload": [str(tmp_path / "counts.py")]}),
        LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        lazy = sd.compute(mended(), window=32, **SIZES)
        np.testing.assert_array_equal(np.asarray(lazy.compute()).view(np.uint32), whole.numpy().view(np.uint32))
        assert len(list(decided.iterdir())) == 1
        sd.write(tmp_path / "field.zarr", mended(), client=client, **SIZES | {"resolution": 100}, **LAYOUT)
        assert len(list(decided.iterdir())) == 1  # the client decided
    np.testing.assert_array_equal(
        so.load(tmp_path / "field.zarr").numpy(), so.field(mended(), **SIZES | {"resolution": 100}).numpy()
    )


# A decision travels for the signs and methods that need only what is near a window.
def test_what_needs_only_a_part_of_the_mesh_is_known():
    def is_whole(**options):
        return so.FieldWindows(MESH, window=32, device="cpu", **SIZES, **options).is_whole

    methods = get_args(inspect.get_annotations(so.FieldWindows.__init__, eval_str=True)["method"])
    assert {name for name in methods if not is_whole(method=name)} == set(METHODS_IN_WINDOWS)
    signs = set(get_args(inspect.get_annotations(so.Sign, eval_str=True)["method"])) - {"none", "shell"}
    assert {name for name in signs if not is_whole(sign=name)} == set(SIGNS_IN_WINDOWS)


def test_tasks_have_several_windows_where_there_are_many():
    for count, threads, most in [(0, 2, 1), (97, 2, 1), (200, 2, 3), (5000, 2, 16), (5000, 1000, 1), (50, 0, 1)]:
        windows = [((16 * n, 0, 0), (16, 16, 16)) for n in range(count)]
        tasks = tasks_of(windows, threads)
        assert [window for task in tasks for window in task] == windows
        assert max(map(len, tasks), default=1) == most and min(map(len, tasks), default=1) > 0


def test_a_store_is_the_field(serial):
    whole = so.field(MESH, **SIZES)
    np.testing.assert_array_equal(zarr.open_array(serial / "0", mode="r")[:], whole.numpy())
    np.testing.assert_array_equal(so.load(serial).numpy(), whole.numpy())


def test_a_cluster_writes_what_one_process_writes(client, serial, tmp_path):
    done = sd.write(tmp_path / "field.zarr", MESH, client=client, **SIZES, **LAYOUT)
    expect_same(tmp_path / "field.zarr", serial)
    assert done.kept == 0 and done.computed + done.empty == done.shards == 4**3
    again = sd.write(tmp_path / "field.zarr", MESH, client=client, **SIZES, **LAYOUT)
    assert again.kept == len(list((serial / "0/c").glob("*/*/*")))
    assert again.computed == done.computed - again.kept
    expect_same(tmp_path / "field.zarr", serial)


def test_levels_have_the_same_bytes_however_they_are_written(client, tmp_path):
    whole = so.field(MESH, **SIZES).numpy()
    sd.write(tmp_path / "a.zarr", MESH, levels=3, **SIZES, **LAYOUT)
    for level in range(3):
        np.testing.assert_array_equal(
            so.open(tmp_path / "a.zarr", level=level)[:], whole[:: 2**level, :: 2**level, :: 2**level]
        )
    sd.write(tmp_path / "b.zarr", MESH, levels=3, client=client, **SIZES, **LAYOUT)
    expect_same(tmp_path / "b.zarr", tmp_path / "a.zarr")
    # Later, and after a part was lost: shards of the field, and of a level that is not listed yet.
    sd.write(tmp_path / "c.zarr", MESH, **SIZES, **LAYOUT)
    sd.write(tmp_path / "c.zarr", MESH, levels=3, **SIZES, **LAYOUT)
    expect_same(tmp_path / "c.zarr", tmp_path / "a.zarr")
    next(path for path in (tmp_path / "c.zarr/0/c").rglob("*") if path.is_file()).unlink()
    next(path for path in (tmp_path / "c.zarr/1/c").rglob("*") if path.is_file()).unlink()
    assert sd.write(tmp_path / "c.zarr", MESH, levels=3, client=client, **SIZES, **LAYOUT).computed > 0
    expect_same(tmp_path / "c.zarr", tmp_path / "a.zarr")
    sd.write(tmp_path / "c.zarr", MESH, **SIZES, **LAYOUT)
    assert so.open(tmp_path / "c.zarr").levels == 3, "a call for fewer takes none away"
    next((tmp_path / "c.zarr/1/c").rglob("*/*/*")).unlink()
    sd.write(tmp_path / "c.zarr", MESH, levels=3, **SIZES, **LAYOUT)
    expect_same(tmp_path / "c.zarr", tmp_path / "a.zarr")
    sd.write("memory://levels/d.zarr", MESH, levels=3, **SIZES, **LAYOUT)
    stored = so.open("memory://levels/d.zarr", level=2)
    np.testing.assert_array_equal(stored[:], whole[::4, ::4, ::4])
    for levels in (0, 40):
        with pytest.raises(ValueError, match="levels: must be 1 to 8"):
            sd.write(tmp_path / "e.zarr", MESH, levels=levels, **SIZES, **LAYOUT)
    assert not (tmp_path / "e.zarr").exists()


def test_what_is_missing_is_computed_again(serial, tmp_path):
    store = tmp_path / "field.zarr"
    shutil.copytree(serial, store)
    removed = sorted((store / "0/c").glob("*/*/*"))[::3]
    for path in removed:
        path.unlink()
    done = sd.write(store, MESH, **SIZES, **LAYOUT)
    assert done.computed >= len(removed)
    expect_same(store, serial)


# Workers and clients that are killed.

KILLER = """
    import os, signal, sys
    from pathlib import Path
    import standoff._targets as targets

    def counted(self, first, window, threads, write=targets.Target.write):
        flag = Path(os.environ["STANDOFF_TEST_KILLED"])
        if first == tuple(map(int, os.environ["STANDOFF_TEST_KILLS"].split(","))):
            if os.environ.get("STANDOFF_TEST_ALWAYS") or not flag.exists():
                flag.touch()
                os.kill(os.getpid(), signal.SIGKILL)
        write(self, first, window, threads)

    if targets.Target.write.__name__ != "counted":  # a worker loads this twice
        targets.Target.write = counted
"""


@pytest.fixture
def deadly_client(tmp_path, monkeypatch):
    """Whose workers die when they would write the window at a sample: at the first time, or always."""
    preload = tmp_path / "deadly.py"
    preload.write_text(textwrap.dedent(KILLER))
    with contextlib.ExitStack() as stack:

        def start(at, always=False):
            monkeypatch.setenv("STANDOFF_TEST_KILLED", str(tmp_path / "killed"))
            monkeypatch.setenv("STANDOFF_TEST_KILLS", ",".join(map(str, at)))
            monkeypatch.setenv("STANDOFF_TEST_ALWAYS", "1" if always else "")
            settings = {"distributed.worker.preload": [str(preload)], "distributed.scheduler.allowed-failures": 1}
            stack.enter_context(dask.config.set(settings))
            cluster = LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0")
            return stack.enter_context(Client(stack.enter_context(cluster)))

        yield start


@pytest.mark.parametrize("at", [(0, 32, 32), (32, 0, 32), (64, 64, 96)])
def test_a_worker_is_killed_at_a_block(at, deadly_client, serial, tmp_path):
    client = deadly_client(at)
    sd.write(tmp_path / "field.zarr", MESH, client=client, **SIZES, **LAYOUT)
    assert (tmp_path / "killed").exists(), "no worker came to that block"
    expect_same(tmp_path / "field.zarr", serial)


@pytest.mark.parametrize("tasks", [32, 2])  # a window each, and fourteen
def test_a_block_that_always_kills_is_named_and_the_others_are_kept(
    tasks, deadly_client, serial, tmp_path, monkeypatch
):
    monkeypatch.setattr("standoff.dask._write.TASKS_OF_A_THREAD", tasks)
    client = deadly_client((32, 0, 32), always=True)
    with pytest.raises(so.Error, match=r"1 of \d+ windows killed .* sample \(32, 0, 32\)"):
        sd.write(tmp_path / "field.zarr", MESH, client=client, **SIZES, **LAYOUT)
    written, whole = content(tmp_path / "field.zarr"), content(serial)
    assert whole.keys() - written.keys() == {"0/c/1/0/1"}
    sd.write(tmp_path / "field.zarr", MESH, **SIZES, **LAYOUT)
    expect_same(tmp_path / "field.zarr", serial)


def test_the_client_is_killed_at_a_block(serial, tmp_path):
    script = tmp_path / "client.py"
    script.write_text(
        textwrap.dedent(KILLER)
        + textwrap.dedent(
            """
            sys.path.insert(0, os.environ["STANDOFF_TEST_FOLDER"])
            import shapes
            import standoff.dask as sd

            sd.write(sys.argv[1], shapes.sphere(8), resolution=120, band=3, shard=32, chunk=16)
            """
        )
    )
    store = tmp_path / "field.zarr"
    environment = os.environ | {
        "STANDOFF_TEST_KILLED": str(tmp_path / "killed"),
        "STANDOFF_TEST_KILLS": "64,32,32",
        "STANDOFF_TEST_FOLDER": str(Path(__file__).parent),
    }
    for _ in range(2):
        ended = subprocess.run([sys.executable, script, store], env=environment, capture_output=True, text=True)
        if ended.returncode == -signal.SIGKILL:
            before = set(content(store))
            assert 2 < len(before) < len(content(serial))
    assert ended.returncode == 0, ended.stderr
    expect_same(store, serial)


# Where stores are.


def test_stores_in_memory_by_fsspec(serial):
    pytest.importorskip("fsspec")
    done = sd.write("memory://bucket/field.zarr", MESH, **SIZES, **LAYOUT)
    import fsspec

    system = fsspec.filesystem("memory")
    found = {
        name.removeprefix("/bucket/field.zarr/"): system.cat_file(name) for name in system.find("/bucket/field.zarr")
    }
    assert found == content(serial)
    again = sd.write("memory://bucket/field.zarr", MESH, **SIZES, **LAYOUT)
    assert again.kept == len([name for name in found if name.startswith("0/c/")]) and again.computed < done.computed
    sd.write("memory://bucket/field.zarr", MESH, overwrite=True, **SIZES, **LAYOUT)


def test_stores_by_obstore(serial, tmp_path):
    store = pytest.importorskip("obstore.store").LocalStore(tmp_path)
    sd.write(store, MESH, **SIZES, **LAYOUT)
    expect_same(tmp_path, serial)


@pytest.fixture
def s3():
    """The address of a double of S3 on this machine, with an empty bucket."""
    server = pytest.importorskip("moto.server").ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    address = "http://{}:{}".format(*server._server.server_address)
    urllib.request.urlopen(urllib.request.Request(f"{address}/bucket", method="PUT")).close()
    yield address
    server.stop()


def test_stores_on_s3_by_obstore(client, serial, s3):
    obstore = pytest.importorskip("obstore")
    config = {"aws_access_key_id": "k", "aws_secret_access_key": "s", "aws_region": "us-east-1"}
    bucket = pytest.importorskip("obstore.store").S3Store(
        "bucket", prefix="a/field.zarr", endpoint=s3, client_options={"allow_http": True}, **config
    )
    sd.write(bucket, MESH, client=client, **SIZES, **LAYOUT)
    found = {item["path"]: bytes(obstore.get(bucket, item["path"]).bytes()) for some in bucket.list() for item in some}
    assert found == content(serial)
    np.testing.assert_array_equal(so.open(bucket)[30:70, 5], so.load(serial).numpy()[30:70, 5])


# Without -X dev, in which aiohttp refuses what moto answers.
def test_stores_on_s3_by_fsspec(serial, s3, tmp_path):
    pytest.importorskip("s3fs")
    script = """
        import sys
        sys.path.insert(0, sys.argv[1])
        import shapes, standoff as so, standoff.dask as sd

        options = {"key": "k", "secret": "s", "client_kwargs": {"endpoint_url": sys.argv[2], "region_name": "us-east-1"}}
        url = "s3://bucket/b/field.zarr"
        sd.write(url, shapes.sphere(8), resolution=120, band=3, shard=32, chunk=16, storage_options=options)
        so.open(url, storage_options=options).load().save(sys.argv[3])
    """
    arguments = [str(Path(__file__).parent), s3, str(tmp_path / "a.npz")]
    subprocess.run([sys.executable, "-c", textwrap.dedent(script), *arguments], check=True)
    np.testing.assert_array_equal(so.load(tmp_path / "a.npz").numpy(), so.load(serial).numpy())


# Many meshes.


def files_of(folder):
    return {name: data for name, data in content(folder).items() if name.startswith("fields/")}


def test_a_cluster_makes_a_batch(client, tmp_path):
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for n in range(24):
        so.Mesh(*shapes.sphere(3 + n % 5)).save(meshes / f"{n:02}.ply")
    (meshes / "bad.stl").write_text("no mesh")
    options = {"resolution": 24, "band": 2}
    serial = so.batch(meshes, tmp_path / "serial", **options)
    done = sd.batch(meshes, tmp_path / "cluster", client=client, parts=5, **options)
    assert files_of(tmp_path / "cluster") == files_of(tmp_path / "serial")
    told = [
        [(row["index"], row["status"], row["file_hash"], row["output"]) for row in r.rows()] for r in (serial, done)
    ]
    assert told[0] == told[1] and len(told[0]) == 25
    assert [row["status"] for row in done.failures()] == ["input"]
    # Nothing is made again.
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "cluster/fields").rglob("*.npz")}
    sd.batch(meshes, tmp_path / "cluster", client=client, parts=5, **options)
    assert before == {path: path.stat().st_mtime_ns for path in (tmp_path / "cluster/fields").rglob("*.npz")}
    listed = sd.batch(sorted(meshes.glob("*.ply")), tmp_path / "listed", client=client, parts=2, **options)
    assert len(list(listed.rows())) == 24 and not listed.failures()


def test_a_worker_is_killed_in_a_batch(tmp_path):
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for n in range(40):
        so.Mesh(*shapes.sphere(40)).save(meshes / f"{n:02}.ply")
    options = {"resolution": 64, "band": 2}
    so.batch(meshes, tmp_path / "serial", **options)
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as connected,
    ):
        pids = connected.run(os.getpid)

        def kill():  # once the first results are there
            while not list((tmp_path / "cluster").rglob("*.npz")):
                time.sleep(0.01)
            os.kill(next(iter(pids.values())), signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        done = sd.batch(meshes, tmp_path / "cluster", client=connected, parts=4, **options)
        killer.join()
    assert len(list(done.rows())) == 40 and not done.failures()
    assert files_of(tmp_path / "cluster") == files_of(tmp_path / "serial")


# What is refused.


def test_blocks_smaller_than_shards_are_refused(tmp_path):
    for block in (16, (32, 32, 16), 48, 0):
        with pytest.raises(ValueError, match="would lose one of both without a word"):
            sd.write(tmp_path / "field.zarr", MESH, block=block, **SIZES, **LAYOUT)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "other", [{"resolution": 121}, {"band": 2}, {"sign": None}, {"mesh": shapes.sphere(9)}, {"shard": 64}, {"chunk": 8}]
)
def test_stores_of_another_field_are_refused(other, serial):
    arguments = {"mesh": MESH, **SIZES, **LAYOUT} | other
    before = content(serial)
    with pytest.raises(so.UsageError, match="another field's"):
        sd.write(serial, arguments.pop("mesh"), **arguments)
    with pytest.raises(so.UsageError, match="exists"):
        sd.write(serial, MESH, resume=False, **SIZES, **LAYOUT)
    assert content(serial) == before


def test_what_standoff_did_not_write_is_not_removed(tmp_path):
    zarr.create_array(tmp_path / "other.zarr", shape=(4, 4), chunks=(2, 2), dtype="i4")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "thesis.txt").write_text("of years")
    for name in ("other.zarr", "folder"):
        before = content(tmp_path / name)
        with pytest.raises(so.Error):
            sd.write(tmp_path / name, MESH, overwrite=True, **SIZES, **LAYOUT)
        assert content(tmp_path / name) == before


def test_windows_of_other_sizes_than_bricks_are_refused():
    with pytest.raises(ValueError, match="multiples of 16"):
        sd.compute(MESH, window=40, **SIZES)


def test_blocks_of_several_shards(serial, tmp_path):
    done = sd.write(tmp_path / "field.zarr", MESH, block=(64, 32, 96), **SIZES, **LAYOUT)
    assert done.computed < 64
    expect_same(tmp_path / "field.zarr", serial)
