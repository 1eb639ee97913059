"""Meshes that somebody brings: order kept, mistakes told."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from risorius import assets

# Vertices 1 and 3 lie in the same place, vertex 4 is used by nothing: both have to stay.
OBJ = """v 0 0 0
v 1 0 0
v 0 1 0
v 1 0 0
v 9 9 9
v 1 1 0
f 1 2 3
f 4 6 3
"""


def test_order_and_doubles_are_kept(tmp_path: Path) -> None:
    """Vertex numbers mean the same in the file and in the array."""
    path = tmp_path / "mesh.obj"
    path.write_text(OBJ)
    mesh = assets.read_mesh(path)
    assert mesh.vertices.tolist()[3:] == [[1, 0, 0], [9, 9, 9], [1, 1, 0]]
    assert mesh.faces.tolist() == [[0, 1, 2], [3, 5, 2]]


@pytest.mark.parametrize("suffix", ["ply", "off", "glb"])
def test_other_formats(tmp_path: Path, suffix: str) -> None:
    """What trimesh writes comes back with as many vertices and triangles."""
    path = tmp_path / f"ball.{suffix}"
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.export(path)
    mesh = assets.read_mesh(path)
    assert mesh.vertices.shape == ball.vertices.shape
    assert np.array_equal(mesh.faces, ball.faces)


@pytest.mark.parametrize("names", ["s t", "u v", "texture_u texture_v", "texcoord"])
def test_a_ply_file_may_have_texture_coordinates(tmp_path: Path, names: str) -> None:
    """Under any of their names, or at the corners of each face: the mesh is read as it stands."""
    first, *second = names.split()
    at_vertices = f"property float {first}\nproperty float {second[0]}\n" if second else ""
    at_faces = "" if second else f"property list uchar float {first}\n"
    path = tmp_path / "painted.ply"
    path.write_text(
        "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 4\n"
        f"property float x\nproperty float y\nproperty float z\n{at_vertices}element face 2\n"
        f"property list uchar int vertex_indices\n{at_faces}end_header\n"
        + "".join(
            f"{x} {y} 0{f' {x} {y}' * bool(second)}\n" for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
        )
        + "".join(f"3 {face}{' 6 0 0 1 0 1 1' * (not second)}\n" for face in ("0 1 2", "0 2 3"))
    )
    mesh = assets.read_mesh(path)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]] and len(mesh.vertices) == 4


def test_polygons_become_triangles(tmp_path: Path) -> None:
    """A quadrilateral is two triangles."""
    path = tmp_path / "quad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    assert assets.read_mesh(path).faces.shape == (2, 3)


def test_seams_and_materials_keep_vertices_together(tmp_path: Path) -> None:
    """Two materials and a seam of the texture cut nothing: a vertex keeps its number."""
    path = tmp_path / "seam.obj"
    path.write_text(
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl skin\nf 1/1 2/2 3/3\nusemtl lips\nf -4/2 -2/3 -1/4\n"
    )
    mesh = assets.read_mesh(path)
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_corners_of_stl_become_vertices(tmp_path: Path) -> None:
    """STL repeats each corner; what lies in one place is one vertex, in the order of the file."""
    path = tmp_path / "ball.stl"
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.export(path)
    mesh = assets.read_mesh(path)
    assert len(mesh.vertices) == len(ball.vertices)
    assert np.abs(mesh.vertices[mesh.faces] - ball.triangles).max() < 1e-6
    assert mesh.faces[0].tolist() == [0, 1, 2]
