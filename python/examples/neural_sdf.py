# SPDX-License-Identifier: Apache-2.0
"""Trains a small neural signed distance field on the CPU, in about a minute. Needs torch.

Usage: python neural_sdf.py bunny.obj
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
import standoff as so
import torch


class SurfacePoints(torch.utils.data.IterableDataset):
    """Batches of points with their exact signed distances, half of them near the surface. They never repeat, since
    asking again is as quick as reading a file."""

    def __init__(self, mesh: so.Mesh, batch: int = 8192, near: float = 0.02) -> None:
        low, high = map(np.array, mesh.bounds)
        self.mesh = so.Mesh((mesh.vertices - (low + high) / 2) * (2 / (high - low).max()), mesh.faces)  # into [-1, 1]
        self.query = so.MeshQuery(self.mesh, sign="auto")
        corners = self.mesh.vertices[self.mesh.faces]
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        self.corners, self.share = corners, np.cumsum(area) / area.sum()
        self.batch, self.near = batch, near

    def __iter__(self):
        worker = torch.utils.data.get_worker_info()
        rng = np.random.default_rng(worker.seed if worker else 1)
        while True:
            half = self.batch // 2
            chosen = self.corners[np.searchsorted(self.share, rng.random(half)).clip(max=len(self.share) - 1)]
            weights = rng.dirichlet([1, 1, 1], half)
            near = np.einsum("nk,nkd->nd", weights, chosen) + rng.normal(scale=self.near, size=(half, 3))
            points = np.concatenate([near, rng.uniform(-1.1, 1.1, (half, 3))])
            points = torch.from_numpy(points.astype(np.float32))
            yield points, self.query.distance(points)  # a tensor, as the points are


class Network(torch.nn.Module):
    """Fourier features and three hidden layers."""

    def __init__(self, features: int = 64, width: int = 128) -> None:
        super().__init__()
        generator = torch.Generator().manual_seed(1)
        self.register_buffer("directions", 4 * torch.randn(3, features, generator=generator))
        layers: list[torch.nn.Module] = []
        for size in (2 * features + 3, width, width):
            layers += [torch.nn.Linear(size, width), torch.nn.ReLU()]
        self.layers = torch.nn.Sequential(*layers, torch.nn.Linear(width, 1))

    def forward(self, points: torch.Tensor) -> torch.Tensor:
        waves = points @ self.directions
        return self.layers(torch.cat([points, waves.sin(), waves.cos()], dim=-1)).squeeze(-1)


def train(data: SurfacePoints, seconds: float) -> Network:
    torch.manual_seed(1)
    network = Network()
    steps = torch.optim.Adam(network.parameters(), lr=2e-3)
    began = time.monotonic()
    for number, (points, distances) in enumerate(data):
        # Far from the surface the distance matters less.
        loss = (network(points).clamp(-0.1, 0.1) - distances.clamp(-0.1, 0.1)).abs().mean()
        steps.zero_grad()
        loss.backward()
        steps.step()
        if number % 100 == 0:
            print(f"{time.monotonic() - began:5.1f} s, step {number}: mean error {loss.item():.5f}", flush=True)
        if time.monotonic() - began > seconds:
            return network
    raise AssertionError("the data never ends")


def main(path: str, seconds: float = 60, resolution: int = 96) -> float:
    data = SurfacePoints(so.read(path))
    network = train(data, seconds)
    # What the network learnt, as a field, and out of it a mesh.
    grid = so.Grid.fit(data.mesh, resolution=resolution)
    points = torch.from_numpy(grid.points().astype(np.float32))
    with torch.no_grad():
        values = torch.stack([network(plane.reshape(-1, 3)).reshape(plane.shape[:-1]) for plane in points])
    learnt = so.DistanceField.from_numpy(values.numpy(), grid)
    so.surface(learnt).save(Path(path).stem + "-learnt.ply")
    exact = so.field(data.mesh, grid=grid).numpy()
    wrong = float(((learnt.numpy() < 0) != (exact < 0)).mean())
    print(f"{100 * wrong:.2f} % of the samples have the wrong sign; wrote {Path(path).stem}-learnt.ply")
    return wrong


if __name__ == "__main__":
    main(sys.argv[1], *(float(seconds) for seconds in sys.argv[2:3]))
