# SPDX-License-Identifier: Apache-2.0
"""Windows of fields: parts with the bits of the whole, computed without it."""

import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest
import shapes
import standoff as so

FAR = (1000.1, -20000.3, 0.7)
MESH = shapes.sphere(6)[0] + FAR, shapes.sphere(6)[1]
SIZES = {"shape": (53, 47, 61), "thickness": 0.2}


def bits(values):
    return values.view(np.uint32)


def part_of(whole, first, shape):
    return whole[tuple(slice(at, at + n) for at, n in zip(first, shape))]


@pytest.mark.parametrize("sign", ["auto", "flood", "normal", None])
@pytest.mark.parametrize("nearest", [False, True])
def test_windows_are_parts_of_the_whole_field(sign, nearest):
    whole = so.field(MESH, sign=sign, nearest=nearest, **SIZES)
    windows = so.FieldWindows(MESH, window=(32, 16, 48), sign=sign, nearest=nearest, **SIZES)
    assert windows.grid == whole.grid and windows.thickness == whole.thickness
    assert windows.is_whole == (sign == "normal")
    count = 0
    for first, shape in windows:
        field = windows.field(first, shape)
        assert field.grid == whole.grid.window(first, shape)
        np.testing.assert_array_equal(bits(field.numpy()), bits(part_of(whole.numpy(), first, shape)))
        np.testing.assert_array_equal(field.grid.points(), part_of(whole.grid.points(), first, shape))
        if nearest:
            np.testing.assert_array_equal(field.nearest(), part_of(whole.nearest(), first, shape))
        count += 1
    assert count == 2 * 3 * 2
    odd = windows.field((5, 7, 11), (20, 3, 13))
    np.testing.assert_array_equal(bits(odd.numpy()), bits(part_of(whole.numpy(), (5, 7, 11), (20, 3, 13))))


OPEN = MESH[0], np.delete(MESH[1], range(40, 55), axis=0)[:, [1, 0, 2]]


@pytest.mark.filterwarnings("ignore::standoff.SignWarning")
@pytest.mark.parametrize("mesh", [MESH, OPEN])
@pytest.mark.parametrize("sign", ["auto", "flood", "normal", None, so.Sign(invert=True)])
def test_a_decision_of_another_process(mesh, sign, tmp_path):
    # The other process decides; this one computes by what it sends.
    script = """
        import sys
        import numpy as np, standoff as so

        kept = np.load(sys.argv[1])
        sign = so.Sign(invert=True) if sys.argv[2] == "inverted" else sys.argv[2]
        windows = so.FieldWindows((kept["v"], kept["f"]), window=16, shape=(53, 47, 61), thickness=0.2, sign=sign)
        sys.stdout.buffer.write(windows.decision)
    """
    np.savez(tmp_path / "mesh.npz", v=mesh[0], f=mesh[1])
    words = "inverted" if isinstance(sign, so.Sign) else sign or "none"
    arguments = [sys.executable, "-c", textwrap.dedent(script), tmp_path / "mesh.npz", words]
    decision = subprocess.run(arguments, check=True, capture_output=True).stdout
    whole = so.field(mesh, sign=sign, **SIZES)
    windows = so.FieldWindows(mesh, window=(32, 16, 48), sign=sign, decision=decision, **SIZES)
    assert windows.decision == decision and windows.sign == whole.sign
    for first, shape in windows:
        np.testing.assert_array_equal(
            bits(windows.field(first, shape).numpy()), bits(part_of(whole.numpy(), first, shape))
        )


@pytest.mark.filterwarnings("ignore::standoff.SignWarning")
def test_decisions_of_something_else_are_refused():
    decision = so.FieldWindows(OPEN, window=16, **SIZES).decision
    with pytest.raises(so.UsageError, match="another mesh"):
        so.FieldWindows(MESH, window=16, decision=decision, **SIZES)
    with pytest.raises(so.UsageError, match="the sign method auto, not flood"):
        so.FieldWindows(OPEN, window=16, sign="flood", decision=decision, **SIZES)
    for damaged in (b"", decision[:-1], b"x" * 200):
        with pytest.raises(so.Error, match="sign decision"):
            so.FieldWindows(OPEN, window=16, decision=damaged, **SIZES)
    with pytest.raises(TypeError, match="decision: give the bytes"):
        so.FieldWindows(OPEN, window=16, decision="text", **SIZES)


def test_windows_that_no_triangle_reaches():
    windows = so.FieldWindows(MESH, window=16, resolution=400, band=2)
    assert windows.is_reached((192, 192, 0), (16, 16, 16))
    assert not windows.is_reached((192, 192, 192), (16, 16, 16))
    assert (windows.field((192, 192, 192), (16, 16, 16)).numpy() == np.float32(-windows.thickness)).all()
    assert (windows.field((0, 0, 0), (16, 16, 16)).numpy() == np.float32(windows.thickness)).all()


def test_one_call_at_a_time_from_any_thread():
    whole = so.field(MESH, **SIZES).numpy()
    windows = so.FieldWindows(MESH, window=16, threads=1, **SIZES)
    wrong = []

    def compute(places):
        for first, shape in places:
            if not np.array_equal(windows.field(first, shape).numpy(), part_of(whole, first, shape)):
                wrong.append(first)

    places = list(windows)
    threads = [threading.Thread(target=compute, args=(places[n::4],)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_progress_and_interruption():
    windows = so.FieldWindows(MESH, window=48, **SIZES)
    seen = []
    windows.field((0, 0, 0), (48, 47, 48), progress=lambda stage, fraction: seen.append(fraction))
    assert seen

    def stop(stage, fraction):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        so.FieldWindows(shapes.sphere(200), window=256, resolution=256).field((0, 0, 0), (256, 256, 256), progress=stop)
    windows.field((0, 0, 0), (16, 16, 16))


@pytest.mark.parametrize(
    ("first", "shape", "says"),
    [
        ((0, 0, 0), (49, 16, 16), "announce"),
        ((-1, 0, 0), (16, 16, 16), "no window of the grid"),
        ((48, 0, 0), (16, 16, 16), "along x, which has 53|53 there"),
        ((0, 0, 0), (0, 16, 16), "no window of the grid"),
    ],
)
def test_what_is_no_window(first, shape, says):
    windows = so.FieldWindows(MESH, window=48, **SIZES)
    for ask in (windows.field, windows.is_reached):
        with pytest.raises(so.UsageError, match=says):
            ask(first, shape)


def test_windows_of_grids():
    grid = so.Grid((50, 40, 30), (1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    window = grid.window((16, 8, 0), (10, 20, 30))
    assert window == so.Grid((10, 20, 30), (1.0, 2.0, 3.0), (0.1, 0.2, 0.3), (16, 8, 0))
    assert window.window((1, 2, 3), (4, 5, 6)).first == (17, 10, 3)
    assert window.bounds[0] == tuple(grid.points()[16, 8, 0])
    assert window.bounds[1] == tuple(grid.points()[25, 27, 29])
    for first, shape in [
        ((0, 0, 0), (51, 1, 1)),
        ((49, 0, 0), (2, 1, 1)),
        ((0, -1, 0), (1, 1, 1)),
        ((0, 0, 0), (0, 1, 1)),
    ]:
        with pytest.raises(ValueError, match="not all in the grid"):
            grid.window(first, shape)
