# SPDX-License-Identifier: Apache-2.0
"""The examples of python/examples, where the libraries they are for are installed (requirements-peers.txt)."""

import importlib.util
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def example(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.filterwarnings("default")
def test_a_neural_field_learns_the_bunny(bunny_path, tmp_path, monkeypatch):
    pytest.importorskip("torch")
    monkeypatch.chdir(tmp_path)
    assert example("neural_sdf").main(bunny_path, seconds=10, resolution=48) < 0.05
    assert (tmp_path / "bunny-learnt.ply").exists()


@pytest.mark.filterwarnings("default")
def test_warp_reads_the_same_values(bunny_path):
    pytest.importorskip("warp")
    assert example("warp_volume").main(bunny_path) < 1e-4


@pytest.mark.filterwarnings("default")
def test_a_part_comes_to_rest_in_mujoco(bunny_path):
    pytest.importorskip("mujoco")
    assert 0.1 < example("mujoco_part").main(bunny_path) < 1.1
