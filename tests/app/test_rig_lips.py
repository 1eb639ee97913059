"""A head with sealed lips: cut along its landmarks, and written with some added vertices."""

import json
from dataclasses import replace

import numpy as np
import pytest

from risorius import sim
from risorius.assets import AssetError
from risorius.assets.fitting import fit_head
from risorius.assets.fitting.lips import lip_cut
from risorius.assets.meshes import read_mesh
from tests.sim.poses import advance

from ..assets.gltf_files import GltfMaker
from ..heads import METRES_PER_MILLIMETRE, UserHead, closed, masked, nearly_shut, sealed
from .command_line import succeeded
from .glb_player import Player

UPPER_LIP_LANDMARK = 62  # landmarks in the middle of the lips
LOWER_LIP_LANDMARK = 66


@pytest.fixture(scope="module")
def shut() -> UserHead:
    """The built-in head with sealed lips [mm]."""
    return sealed()


@pytest.mark.slow
def test_an_avatar_keeps_triangles_across_mouth_and_eyes(tmp_path):
    """An avatar keeps the triangles that fill mouth and eyes, in the file's order.

    The filling moves with the lips.
    """
    mask = masked()
    mesh, marks = mask.write(tmp_path)
    path = tmp_path / "avatar.glb"
    succeeded("rig", mesh, "--landmarks", marks, "-o", path)
    player = Player(path)
    places = player.attribute("head", "POSITION")
    assert np.abs(places - mask.mesh.vertices).max() < 1e-4
    assert np.array_equal(read_mesh(path).faces, mask.mesh.faces)
    opened = player.shapes("head")["jawOpen"][mask.landmarks, 1]
    assert opened[LOWER_LIP_LANDMARK] < opened[UPPER_LIP_LANDMARK] - 15.0


@pytest.mark.slow
def test_skin_between_the_lids_shuts_with_them(shut, tmp_path):
    """The front of an eyeball that is part of the skin does not pierce the shut lids."""
    eye = shut.landmarks[42:48]
    mesh = closed(shut.mesh, eye)
    middle = len(mesh.vertices) - 1
    bulged = mesh.vertices + 0.0
    bulged[middle, 2] += 3.0  # [mm]
    files = UserHead(replace(mesh, vertices=bulged), shut.landmarks).write(tmp_path)
    path = tmp_path / "avatar.glb"
    lines = succeeded("rig", files[0], "--landmarks", files[1], "--parts", "-o", path)
    assert "skin behind the lips" not in lines and "not in the file" not in lines
    player = Player(path)
    parts = {mesh.name for mesh in player.file.meshes}
    assert "oral_cavity_upper" in parts
    assert "eyeball_left" not in parts
    blink = player.shapes("head")["eyeBlinkLeft"]
    shut = bulged + blink[: len(bulged)]
    upper = shut[eye[[1, 2]], 1].mean()
    lower = shut[eye[[5, 4]], 1].mean()
    place = shut[middle, 1]
    assert lower - 2.0 < place < upper + 2.0


def write_glb(shut, folder):
    """Write the sealed head as a GLB whose halves have separate vertices at the seam."""
    vertices = shut.mesh.vertices
    faces = shut.mesh.faces
    is_left = vertices[faces, 0].mean(axis=1) > 0.0
    other = np.intersect1d(faces[is_left], faces[~is_left])
    number = np.arange(len(vertices))
    number[other] = len(vertices) + np.arange(len(other))
    corners = np.where(is_left[:, None], number[faces], faces)
    doubled = np.vstack([vertices, vertices[other]])
    uv = doubled[:, :2] / 400.0 + 0.5
    uv[len(vertices) :] += 0.01
    maker = GltfMaker()
    uv_accessor = maker.accessor(uv)
    attributes = {"TEXCOORD_0": uv_accessor, "_MASK": maker.accessor(np.linspace(0, 1, len(uv)))}
    primitive = maker.primitive(METRES_PER_MILLIMETRE * doubled, corners, attributes=attributes)
    maker.shown({"name": "head", "mesh": maker.mesh(primitive)})
    marks = folder / "marks.json"
    marks.write_text(json.dumps({"landmarks": shut.landmarks.tolist()}))
    return maker.write(folder / "sealed.glb"), marks, doubled, uv


def test_sealed_lips_are_cut_and_part(shut, tmp_path):
    """A line has the number of doubled vertices; with an open jaw the cut lips part.

    The corners stay together.
    """
    head = fit_head(*shut.write(tmp_path))
    (note,) = head.notes
    added = len(head.vertices) - len(shut.mesh.vertices)
    assert 8 < added < 30
    assert note == f"its lips were sealed: they are cut apart, {added} vertices are doubled"
    upper, lower = head.landmarks[[UPPER_LIP_LANDMARK, LOWER_LIP_LANDMARK]]
    assert upper != lower
    assert np.array_equal(head.vertices[upper], head.vertices[lower])
    simulation = sim.create(head)
    simulation.controls.set("jawOpen", 1.0)
    advance(simulation, 60)
    places = simulation.positions
    assert places[upper, 1] - places[lower, 1] > 15.0
    assert np.abs(places - head.vertices).max() < 60.0


def test_a_cut_runs_along_edges_of_the_mesh(shut):
    """The cut follows edges in any unit; both lips keep all triangles.

    No other vertex is doubled.
    """
    mesh = shut.mesh
    tiny = replace(mesh, vertices=METRES_PER_MILLIMETRE * mesh.vertices)
    cut = lip_cut(tiny, shut.landmarks, tiny.vertices[shut.landmarks])
    opened = cut.applied(tiny)
    assert len(opened.faces) == len(mesh.faces)
    doubled = np.concatenate([np.arange(len(mesh.vertices)), cut.sources])
    assert np.array_equal(doubled[opened.faces], mesh.faces)
    line = np.unique(doubled[opened.faces[(opened.faces != mesh.faces).any(axis=1)]])
    assert np.isin(cut.sources, line).all()
    width = np.ptp(mesh.vertices[shut.landmarks[[60, 64]], 0])
    middle = mesh.vertices[shut.landmarks[62]]
    assert np.abs(mesh.vertices[cut.sources, 1] - middle[1]).max() < 0.15 * width


def test_skin_across_an_open_mouth_is_not_cut(shut):
    """Lips that are apart are not sealed: the user must remove the triangles between them."""
    places = shut.mesh.vertices[shut.landmarks]
    places[61:64, 1] += 5.0
    places[65:68, 1] -= 5.0
    assert lip_cut(shut.mesh, shut.landmarks, places) is None


def test_a_fault_of_a_cut_head_names_the_cut(shut, tmp_path):
    """Skin over a narrow eye, found after the lips were cut, is reported together with the cut."""
    landmarks = shut.landmarks
    eye = landmarks[42:48]
    covered = UserHead(closed(nearly_shut(shut.mesh, eye), eye), landmarks)
    with pytest.raises(AssetError, match=r"lips were sealed: .*; but the left eye has no opening"):
        fit_head(*covered.write(tmp_path))


def test_a_cut_takes_the_vertices_of_the_mesh_that_is_cut(shut, tmp_path):
    """The cut doubles vertices of the final mesh, not those of an earlier attempt.

    In the earlier attempt, vertices of a seam across the lips were separate.
    """
    path, marks, doubled, _ = write_glb(shut, tmp_path)
    numbers = shut.landmarks.copy()
    other = np.flatnonzero((doubled == doubled[numbers[UPPER_LIP_LANDMARK]]).all(axis=1))[-1]
    assert other != numbers[UPPER_LIP_LANDMARK]
    thin_lip = 51  # outer border of an upper lip without height
    numbers[thin_lip] = other
    marks.write_text(json.dumps({"landmarks": numbers.tolist()}))
    head = fit_head(path, marks)
    assert head.lip_cut is not None
    assert head.landmarks[thin_lip] == head.landmarks[UPPER_LIP_LANDMARK]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_an_avatar_has_the_files_vertices_and_few_more(shut, tmp_path, kind):
    """The file's vertices come first with their attributes, and jawOpen parts the doubled ones."""
    if kind == "glb":
        mesh, marks, own, uv = write_glb(shut, tmp_path)
        unit = METRES_PER_MILLIMETRE
    else:
        mesh, marks = shut.write(tmp_path)
        own = shut.mesh.vertices
        unit = 1.0
    path = tmp_path / "avatar.glb"
    succeeded("rig", mesh, "--landmarks", marks, "-o", path)
    player = Player(path)
    points = player.attribute("head", "POSITION") / unit
    assert np.abs(points[: len(own)] - own).max() < 1e-4
    more = points[len(own) :]
    assert 8 < len(more) < 40
    moved = player.shapes("head")["jawOpen"] / unit
    parted = 0
    for place, point in enumerate(more, start=len(own)):
        same = np.flatnonzero(np.abs(points[: len(own)] - point).max(axis=1) < 1e-5)
        parted = max(parted, np.abs(moved[same, 1] - moved[place, 1]).max())
        if kind == "glb":
            coordinates = player.attribute("head", "TEXCOORD_0")
            assert np.abs(uv[same] - coordinates[place]).sum(axis=1).min() < 1e-6
    if kind == "glb":  # a scalar, as in Blender's user attributes
        mask = player.attribute("head", "_MASK").ravel()
        assert len(mask) == len(points)
        assert np.abs(mask[: len(own)] - np.linspace(0.0, 1.0, len(own))).max() < 1e-6
    assert parted > 15.0
    corners = player.values(player.primitive("head").indices)
    assert len(corners) == 3 * len(shut.mesh.faces)
    assert set(range(len(points))) == set(corners.tolist())
    assert len(read_mesh(path).vertices) == len(points)


def write_polygons(shut, mesh):
    """Write the sealed head as artists do: quads where two triangles make one, and groups.

    Triangles behind the ears and the last vertex form another group with negative numbers.
    """
    faces = shut.mesh.faces.tolist()
    vertices = shut.mesh.vertices
    partner = {}
    for number, (a, b, c) in enumerate(faces):
        partner.update({(a, b): number, (b, c): number, (c, a): number})
    lines = [
        "# An artist's",
        "g head",
        *(f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in vertices[:-1]),
    ]
    lines += ["vt 0.5 0.5", "usemtl skin"]
    quads = []
    joined = set()
    for number, (a, b, c) in enumerate(faces):
        other = partner.get((a, c))
        if (
            number in joined
            or other is None
            or other in joined
            or len(vertices) - 1 in faces[other]
        ):
            continue
        (d,) = set(faces[other]) - {a, c}
        joined |= {number, other}
        quads.append((a, b, c, d))
        lines.append("f " + " ".join(f"{each + 1}/1" for each in (a, b, c, d)))
    lines += ["g rest", "v {:.9f} {:.9f} {:.9f}".format(*vertices[-1])]
    for number, corners in enumerate(faces):
        if number not in joined:
            lines.append("f " + " ".join(f"{each - len(vertices)}/-1" for each in corners))
    mesh.write_text("\r\n".join(lines) + "\r\n")
    return quads


def polygons_of(path):
    """The corners of an OBJ's polygons as absolute numbers."""
    lines = path.read_text().splitlines()
    rows = [line.split()[1:] for line in lines if line.startswith("f ")]

    def vertex_of(corner):
        number, _, _ = corner.partition("/")
        return int(number) - 1

    return [[vertex_of(corner) for corner in row] for row in rows]


def other_lines(lines):
    """The lines of an OBJ besides those of vertices and polygons."""
    return [line for line in lines if not line.startswith(("v ", "f "))]


@pytest.mark.slow
def test_a_folder_of_objs_has_the_cut(shut, tmp_path):
    """All OBJ files have the same vertices, polygons and groups, with the file's vertices first."""
    mesh, marks = shut.write(tmp_path)
    quads = write_polygons(shut, mesh)
    folder = tmp_path / "shapes"
    words = ("--as", "obj", "--shapes", "visemes", "--quiet", "-o", folder)
    succeeded("rig", mesh, "--landmarks", marks, *words)
    neutral = read_mesh(folder / "neutral.obj")
    count = len(shut.mesh.vertices)
    assert np.abs(neutral.vertices[:count] - shut.mesh.vertices).max() < 1e-5
    opened = read_mesh(folder / "viseme_aa.obj")
    assert len(opened.vertices) == len(neutral.vertices) > count
    cut = fit_head(mesh, marks).lip_cut.applied(read_mesh(mesh))
    expected = {tuple(sorted(corners)) for corners in cut.faces.tolist()}
    assert {tuple(sorted(corners)) for corners in neutral.faces.tolist()} == expected
    kept = [corners for corners in polygons_of(folder / "neutral.obj") if len(corners) == 4]
    assert len(quads) - 20 < len(kept) < len(quads)  # the cut crosses some
    lines = (folder / "neutral.obj").read_text().splitlines()
    assert other_lines(lines) == other_lines(mesh.read_text().splitlines())
    assert all(line.count("/") in (3, 4) for line in lines if line.startswith("f "))
