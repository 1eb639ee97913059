"""Meshes of users: order is kept, and mistakes are reported."""

import struct
from itertools import pairwise

import numpy as np
import pytest
import trimesh

from risorius import assets

# Vertices 1 and 3 are at the same place, and vertex 4 is unused: both must stay.
OBJ = """v 0 0 0
v 1 0 0
v 0 1 0
v 1 0 0
v 9 9 9
v 1 1 0
f 1 2 3
f 4 6 3
"""


def test_order_and_doubles_are_kept(tmp_path):
    """Vertices keep the file's numbers in the array, also doubled and unused vertices."""
    path = tmp_path / "mesh.obj"
    path.write_text(OBJ)
    mesh = assets.read_mesh(path)
    assert mesh.vertices.tolist()[3:] == [[1, 0, 0], [9, 9, 9], [1, 1, 0]]
    assert mesh.faces.tolist() == [[0, 1, 2], [3, 5, 2]]


@pytest.mark.parametrize("suffix", ["ply", "off", "glb"])
def test_other_formats(tmp_path, suffix):
    """A file written by trimesh is read with the same numbers of vertices and triangles."""
    path = tmp_path / f"ball.{suffix}"
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.export(path)
    mesh = assets.read_mesh(path)
    assert mesh.vertices.shape == ball.vertices.shape
    assert np.array_equal(mesh.faces, ball.faces)


@pytest.mark.parametrize("names", ["s t", "u v", "texture_u texture_v", "texcoord"])
def test_a_ply_file_may_have_texture_coordinates(tmp_path, names):
    """Texture coordinates of a PLY file are read, under any usual name, or at face corners."""
    first, *second = names.split()
    at_vertices = f"property float {first}\nproperty float {second[0]}\n" if second else ""
    at_faces = "" if second else f"property list uchar float {first}\n"
    lines = [
        "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 4",
        f"property float x\nproperty float y\nproperty float z\n{at_vertices}element face 2",
        f"property list uchar int vertex_indices\n{at_faces}end_header",
    ]
    for place in ("0 0", "1 0", "1 1", "0 1"):
        lines.append(f"{place} 0 {place}" if second else f"{place} 0")
    for face in ("0 1 2", "0 2 3"):
        lines.append(f"3 {face}" if second else f"3 {face} 6 0 0 1 0 1 1")
    path = tmp_path / "painted.ply"
    path.write_text("\n".join(lines) + "\n")
    mesh = assets.read_mesh(path)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert len(mesh.vertices) == 4


def test_polygons_become_triangles(tmp_path):
    """A quadrilateral is two triangles."""
    path = tmp_path / "quad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    assert assets.read_mesh(path).faces.shape == (2, 3)


def test_seams_and_materials_keep_vertices_together(tmp_path):
    """Two materials and a texture seam split no vertex: each keeps its number."""
    path = tmp_path / "seam.obj"
    path.write_text(
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl skin\nf 1/1 2/2 3/3\nusemtl lips\nf -4/2 -2/3 -1/4\n"
    )
    mesh = assets.read_mesh(path)
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_corners_of_stl_become_vertices(tmp_path):
    """Corners of an STL file at one place become one vertex, in the order of the file."""
    path = tmp_path / "ball.stl"
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.export(path)
    mesh = assets.read_mesh(path)
    assert len(mesh.vertices) == len(ball.vertices)
    assert np.abs(mesh.vertices[mesh.faces] - ball.triangles).max() < 1e-6
    assert mesh.faces[0].tolist() == [0, 1, 2]


HOUSE_CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 1.5, 0)]
HOUSE_FACES = [[0, 1, 2], [0, 2, 3], [2, 4, 3]]


def ply(form, lists, element="face", **more):
    """A PLY file of five points, and lists of point numbers.

    more: "kind", the type of the lists' numbers; "colours", a row for each point; "names" and
    "colour_kind" of the colours.
    """
    kind = more.get("kind", "int")
    colours = more.get("colours")
    colour_kind = more.get("colour_kind", "uchar")
    names = more.get("names", "red green blue").split() if colours is not None else []
    lines = [
        "ply",
        f"format {form} 1.0",
        "comment made by hand",
        f"element vertex {len(HOUSE_CORNERS)}",
    ]
    lines += [f"property double {axis}" for axis in "xyz"]
    lines += [f"property {colour_kind} {name}" for name in names]
    lines += [f"element {element} {len(lists)}", "property uchar flags"]
    lines += [f"property list uchar {kind} vertex_index", "end_header\n"]
    header = "\n".join(lines).encode()
    rows = [] if colours is None else [[*row] for row in colours]
    if form == "ascii":
        points = [[*xyz, *row] for xyz, row in zip(HOUSE_CORNERS, rows or [[]] * 5, strict=True)]
        body = [*points, *([7, len(each), *each] for each in lists)]
        text = [" ".join(map(str, row)) + "\n" for row in body]
        return header + "".join(text).encode()
    order = ">" if "big" in form else "<"
    letters = {"uchar": "B", "ushort": "H", "float": "f", "int": "i", "uint": "I"}
    body = b""
    for place, xyz in enumerate(HOUSE_CORNERS):
        body += struct.pack(f"{order}3d", *xyz)
        if rows:
            body += struct.pack(f"{order}{len(names)}{letters[colour_kind]}", *rows[place])
    for each in lists:
        body += struct.pack(f"{order}BB{len(each)}{letters[kind]}", 7, len(each), *each)
    return header + body


PLY_FORMS = ("ascii", "binary_little_endian", "binary_big_endian")


@pytest.mark.parametrize("form", PLY_FORMS)
@pytest.mark.parametrize("lists", [HOUSE_FACES, [[0, 1, 2, 3], [2, 4, 3]], [[0, 1, 2, 4, 3]]])
def test_polygons_of_ply_may_be_of_any_sizes(tmp_path, form, lists):
    """A polygon of any size becomes a fan, in the order of the file."""
    path = tmp_path / "house.ply"
    path.write_bytes(ply(form, lists))
    mesh = assets.read_mesh(path)
    assert mesh.vertices.tolist() == [list(map(float, each)) for each in HOUSE_CORNERS]
    fans = [[first, *side] for first, *others in lists for side in pairwise(others)]
    assert mesh.faces.tolist() == fans
    assert mesh.colours is None


@pytest.mark.parametrize("form", PLY_FORMS)
def test_ply_files_may_hold_strips(tmp_path, form):
    """Strips end at -1, and every second triangle of a strip is reversed."""
    path = tmp_path / "strips.ply"
    path.write_bytes(ply(form, [[1, 2, 0, 3, -1, 2, 4, 3], [3, 3, 0, 1]], "tristrips"))
    mesh = assets.read_mesh(path)
    assert mesh.faces.tolist() == [[1, 2, 0], [0, 2, 3], [2, 4, 3], [0, 3, 1]]


@pytest.mark.parametrize("form", PLY_FORMS)
@pytest.mark.parametrize(
    ("colour_kind", "row", "names"),
    [
        ("uchar", (250, 125, 1), "red green blue"),
        ("uchar", (250, 125, 1, 9), "r g b a"),
        ("uchar", (250, 125, 1), "diffuse_red diffuse_green diffuse_blue"),
        ("uchar", (1, 1, 1), "red green blue"),
        ("float", (250 / 255, 125 / 255, 1 / 255), "red green blue"),
        ("ushort", (250 * 257, 125 * 257, 257), "red green blue"),
        ("int", (250, 125, 1), "red green blue"),
    ],
)
def test_colours_of_ply_may_be_of_any_kind(tmp_path, form, colour_kind, row, names):
    """Colours are read as integers of 8 or 16 bits or as fractions, with all usual names."""
    path = tmp_path / "house.ply"
    colours = {"colours": [row] * 5, "colour_kind": colour_kind, "names": names}
    path.write_bytes(ply(form, HOUSE_FACES, **colours))
    mesh = assets.read_mesh(path)
    wanted = [1, 1, 1] if row == (1, 1, 1) else [250, 125, 1]
    assert mesh.colours.tolist() == [wanted] * 5
    assert mesh.faces.tolist() == HOUSE_FACES


@pytest.mark.parametrize("end", ["\r\n", " \r\n", "\n"])
def test_lines_may_end_anyhow(tmp_path, end):
    """Any line ends are read: in text PLY, in headers of binary PLY, and in OBJ.

    OBJ lines may continue after a backslash.
    """
    text = ply("ascii", HOUSE_FACES)
    head, body = ply("binary_little_endian", HOUSE_FACES).split(b"end_header\n")
    files = {
        "text.ply": text.replace(b"\n", end.encode()),
        "bytes.ply": head.replace(b"\n", end.encode()) + b"end_header" + end.encode() + body,
        "tabs.obj": (
            "# in C:\\models\\\nv\t0 0 0\t\nv 1 0 0 \nv 1 \\\n 1 0\n  v 0 1 0\nv .5 1.5 0\n"
            "f\t1 2 \\\n\t3\nf 1//\t3// 4//  # roof\nf 3 5 4\n"
        )
        .replace("\n", end)
        .encode(),
    }
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
        mesh = assets.read_mesh(tmp_path / name)
        assert mesh.faces.tolist() == HOUSE_FACES
        assert mesh.vertices.tolist() == [list(map(float, each)) for each in HOUSE_CORNERS]
