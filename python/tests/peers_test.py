# SPDX-License-Identifier: Apache-2.0
"""The real trimesh and meshio: their meshes in, and answers compared with theirs."""

import meshio
import numpy as np
import pytest
import shapes
import standoff as so
import trimesh

POINTS = np.random.default_rng(1).uniform(-1, 1, (200, 3))


def test_trimesh():
    for mesh in (trimesh.creation.box(), trimesh.creation.icosphere(2), trimesh.creation.torus(1, 0.3)):
        ours = so.report(mesh)
        assert ours.triangles == len(mesh.faces)
        assert ours.closed == mesh.is_watertight
        assert ours.volume == pytest.approx(mesh.volume)
        assert ours.area == pytest.approx(mesh.area)
        assert ours.components[0].centroid == pytest.approx(mesh.center_mass, abs=1e-9)
        np.testing.assert_allclose(so.Mesh(mesh.vertices, mesh.faces).bounds, mesh.bounds)
        direct = so.field(mesh, resolution=20)
        np.testing.assert_array_equal(direct.numpy(), so.field((mesh.vertices, mesh.faces), resolution=20).numpy())


def test_trimesh_without_a_copy():
    mesh = trimesh.creation.icosphere(2)
    made = so.Mesh(mesh.vertices, mesh.faces)
    for ours, theirs in ((made.vertices, mesh.vertices), (made.faces, mesh.faces)):
        assert ours.__array_interface__["data"] == theirs.__array_interface__["data"]


def test_trimesh_scenes_and_back():
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box())
    scene.add_geometry(trimesh.creation.box(), transform=trimesh.transformations.translation_matrix((3, 0, 0)))
    report = so.report(scene)
    assert report.component_count == 2 and report.volume == pytest.approx(2)
    assert report.bounds == ((-0.5,) * 3, (3.5, 0.5, 0.5))
    surface = so.surface(so.field(scene, resolution=40))
    again = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert again.is_watertight and again.is_winding_consistent
    assert again.volume == pytest.approx(2, rel=0.1)


def test_trimesh_of_a_mesh():
    ours = so.Mesh(*shapes.sphere(8))
    theirs = ours.to_trimesh()
    np.testing.assert_array_equal(theirs.vertices, ours.vertices)
    np.testing.assert_array_equal(theirs.faces, ours.faces)
    assert (theirs.area, theirs.volume, theirs.is_watertight) == (
        pytest.approx(ours.area),
        pytest.approx(ours.volume),
        ours.is_watertight,
    )
    np.testing.assert_array_equal(so.distance(theirs, POINTS), so.distance(ours, POINTS))


def test_trimesh_closest_points():
    mesh = trimesh.creation.icosphere(2)
    ours = so.distance(mesh, POINTS, sign=None, closest=True)
    triangles = mesh.triangles[ours.triangle]
    theirs = trimesh.triangles.closest_point(triangles, POINTS)
    np.testing.assert_allclose(ours.point, theirs, atol=1e-9)
    np.testing.assert_allclose(
        ours.barycentric, trimesh.triangles.points_to_barycentric(triangles, ours.point), atol=1e-7
    )


def test_trimesh_reads_what_we_write(tmp_path):
    ours = so.Mesh(*shapes.sphere(8))
    for extension in (".stl", ".ply", ".obj", ".glb"):
        path = tmp_path / f"mesh{extension}"
        ours.save(path)
        theirs = trimesh.load(path, process=True, force="mesh")
        assert theirs.volume == pytest.approx(so.report(ours).volume, rel=1e-5)
        theirs.export(tmp_path / f"theirs{extension}")
        assert so.report(tmp_path / f"theirs{extension}").volume == pytest.approx(theirs.volume, rel=1e-5)


def test_meshio(tmp_path):
    vertices, faces = shapes.cube()
    mesh = meshio.Mesh(vertices, [("triangle", faces[:6]), ("line", faces[:2, :2]), ("triangle", faces[6:])])
    np.testing.assert_allclose(so.distance(mesh, POINTS), shapes.cube_distance(POINTS), atol=1e-12)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    np.testing.assert_allclose(
        so.distance(meshio.Mesh(vertices, [("quad", quads)]), POINTS),
        shapes.cube_distance(POINTS),
        atol=1e-12,
    )
    for cells in ([("tetra", quads)], [("line", faces[:, :2])], []):
        with pytest.raises(so.MeshError):
            so.field(meshio.Mesh(vertices, cells))
    with pytest.raises(ValueError):
        so.field(meshio.Mesh(vertices[:, :2], [("triangle", faces)]))
    meshio.Mesh(vertices, [("triangle", faces)]).write(tmp_path / "cube.stl")
    assert so.report(tmp_path / "cube.stl").volume == pytest.approx(1)


def test_meshio_reads_our_surfaces(tmp_path):
    surface = so.surface(so.field(shapes.cube(), resolution=12))
    surface.save(tmp_path / "surface.ply")
    theirs = meshio.read(tmp_path / "surface.ply")
    np.testing.assert_allclose(theirs.points, surface.vertices, atol=1e-6)
    np.testing.assert_array_equal(theirs.cells_dict["triangle"], surface.faces)
