"""Meshes of trimesh, as its users load and make them, come back refined with all they carry."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from risorius import refine

CUBE = """mtllib cube.mtl
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl skin
f 1/1 4/2 3/3 2/4
f 5/1 6/2 7/3 8/4
f 1/1 2/2 6/3 5/4
f 2/1 3/2 7/3 6/4
f 3/1 4/2 8/3 7/4
f 4/1 1/2 5/3 8/4
"""


def textured_cube(folder: Path, *, process: bool) -> Any:
    """A cube from an OBJ file, every side of which shows the whole texture."""
    (folder / "cube.obj").write_text(CUBE, encoding="utf-8")
    (folder / "cube.mtl").write_text("newmtl skin\nmap_Kd skin.png\n", encoding="utf-8")
    Image.new("RGB", (4, 4), (200, 120, 90)).save(folder / "skin.png")
    return trimesh.load_mesh(folder / "cube.obj", process=process)


def textured_sphere(*, process: bool) -> Any:
    """A sphere from a GLB file; along one meridian its texture coordinates part."""
    sphere = trimesh.creation.icosphere(subdivisions=2)
    corners = sphere.vertices[sphere.faces]
    angle = np.arctan2(corners[..., 1], corners[..., 0]) / (2.0 * np.pi)
    angle[(np.ptp(angle, axis=1) > 0.5)[:, None] & (angle < 0.0)] += 1.0
    uv = np.stack([angle, corners[..., 2]], axis=2).reshape(-1, 2)
    visual = trimesh.visual.TextureVisuals(uv=uv, image=Image.new("RGB", (4, 4), (90, 120, 200)))
    faces = np.arange(len(uv)).reshape(-1, 3)
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), faces, visual=visual, process=False)
    mesh.vertex_attributes["_heat"] = mesh.vertices[:, 2].astype(np.float32)
    data = io.BytesIO(mesh.export(file_type="glb"))
    return trimesh.load_scene(data, file_type="glb", process=process).to_mesh()


def merged(mesh: Any) -> Any:
    """The same triangles with one vertex at each place."""
    used, faces = refine.weld(mesh.vertices, mesh.faces)
    return trimesh.Trimesh(mesh.vertices[used], faces, process=False)


@pytest.mark.parametrize("process", [False, True])
def test_textured_sphere(process: bool) -> None:
    """From GLB, squeezed: no crack at the seam, whose two sides keep their own texture."""
    mesh = textured_sphere(process=process)
    refiner = refine.TrimeshRefiner(mesh)
    frame = refiner.as_trimesh(mesh.vertices * [1.0, 1.0, 0.5])
    assert len(frame.faces) > 2 * len(mesh.faces)
    assert merged(frame).is_watertight
    assert len(merged(frame).vertices) < len(frame.vertices)
    assert frame.visual.material.baseColorTexture.getpixel((0, 0)) == (90, 120, 200)
    across = np.ptp(frame.visual.uv[frame.faces], axis=1)
    assert across.max() <= np.ptp(mesh.visual.uv[mesh.faces], axis=1).max() + 1e-6
    heat = frame.vertex_attributes["_heat"].ravel()
    assert heat.dtype == np.float32
    assert np.abs(2.0 * frame.vertices[:, 2] - heat).max() < 0.2
    again = trimesh.load_mesh(io.BytesIO(frame.export(file_type="glb")), file_type="glb")
    assert len(again.faces) == len(frame.faces)
    assert again.visual.kind == "texture"


@pytest.mark.parametrize("process", [False, True])
def test_textured_cube(process: bool, tmp_path: Path) -> None:
    """From OBJ: doubled at every edge, closed nonetheless; each side shows its whole texture."""
    mesh = textured_cube(tmp_path, process=process)
    assert len(mesh.vertices) > 8
    frame = refine.TrimeshRefiner(mesh).as_trimesh(mesh.vertices * [1.0, 2.0, 1.0])
    assert len(frame.faces) > 12
    assert merged(frame).is_watertight
    assert set(map(tuple, np.unique(mesh.visual.uv, axis=0).tolist())) <= set(
        map(tuple, frame.visual.uv.tolist())
    )


def test_without_data_it_is_closed() -> None:
    """Where nothing has to part, doubled vertices are one in the output."""
    corners = trimesh.creation.box().triangles.reshape(-1, 3)
    soup = trimesh.Trimesh(corners, np.arange(36).reshape(12, 3), process=False)
    assert not soup.is_watertight
    frame = refine.TrimeshRefiner(soup).as_trimesh(soup.vertices * [1.0, 1.0, 2.0])
    assert frame.is_watertight
    np.testing.assert_allclose(np.linalg.norm(frame.vertex_normals, axis=1), 1.0, atol=1e-5)


def test_colours_and_attributes() -> None:
    """Colours of vertices are mixed, those of faces handed on; attributes likewise."""
    mesh = trimesh.creation.icosphere(subdivisions=1)
    mesh.visual.face_colors = np.arange(len(mesh.faces) * 4).reshape(-1, 4) % 256
    mesh.face_attributes["number"] = np.arange(len(mesh.faces))
    mesh.metadata["name"] = "ball"
    frame = refine.TrimeshRefiner(mesh).as_trimesh(mesh.vertices)
    assert len(frame.faces) > len(mesh.faces)
    assert frame.metadata["name"] == "ball"
    number = frame.face_attributes["number"]
    np.testing.assert_array_equal(frame.visual.face_colors, mesh.visual.face_colors[number])
    centres, normals = frame.triangles_center, mesh.face_normals[number]
    assert (np.einsum("ij,ij->i", centres, normals) > 0.8 * mesh.scale / 4).all()

    painted = mesh.copy()
    shades = np.clip(127.5 * (mesh.vertices[:, :1] + 1.0), 0, 255).astype(np.uint8)
    painted.visual = trimesh.visual.ColorVisuals(
        painted, vertex_colors=np.column_stack([shades, shades, shades])
    )
    frame = refine.TrimeshRefiner(mesh).as_trimesh(painted)  # the frame brings its own
    assert frame.visual.kind == "vertex"
    colours = frame.visual.vertex_colors[:, 0].astype(float)
    assert np.abs(colours - 127.5 * (frame.vertices[:, 0] + 1.0)).max() < 25.0


def test_primitives_and_scenes() -> None:
    """A primitive is refined as the triangles that it shows; of a scene one mesh is asked for."""
    ball = trimesh.primitives.Sphere(subdivisions=1)
    frame = refine.TrimeshRefiner(ball).as_trimesh(ball.vertices)
    assert type(frame) is trimesh.Trimesh
    assert frame.is_watertight
    with pytest.raises(ValueError, match=r"must be a trimesh\.Trimesh, got Scene; of a scene take"):
        refine.TrimeshRefiner(trimesh.Scene(ball))
