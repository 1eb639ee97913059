"""Pictures of users' meshes: read only from the mesh's folder, and laid on its triangles."""

import io
import json
from dataclasses import replace

import numpy as np
import PIL.Image
import pytest
import trimesh
from scipy import ndimage

from risorius import assets, refine
from risorius.assets import AssetError
from risorius.assets.fitting import fit, fit_head
from risorius.assets.fitting.painting import (
    TextureLayout,
    drawn_over,
    maps_in,
    sampled,
    texels_within,
)
from risorius.assets.meshes import Mesh, read_mesh
from tests.heads import UserHead, user_head
from tests.refine.cases import sound_frame

SIZE = 64  # [pixels]


@pytest.fixture(scope="module")
def other() -> UserHead:
    """A head of another shape."""
    return user_head()


def _striped():
    """A picture whose colour encodes the place: red along u, green along v."""
    steps = np.arange(SIZE, dtype=np.uint8) * (256 // SIZE)
    rows = np.dstack([*np.meshgrid(steps, steps[::-1]), np.full((SIZE, SIZE), 60, np.uint8)])
    return PIL.Image.fromarray(rows)


def _uv(other):
    """Texture coordinates of two pieces, the right and the left half, with a seam between."""
    places = other.mesh.vertices[:, [0, 2]]
    places = (places - places.min(axis=0)) / np.ptp(places, axis=0)
    half = places * [0.45, 0.9] + 0.05
    uv = np.vstack([half, half + np.array([0.45, 0.0])])
    is_left = places[other.mesh.faces, 0].mean(axis=1) > 0.5
    return uv, other.mesh.faces + len(places) * is_left[:, None]


def _write_obj(folder, other, picture="skin.png"):
    """Write the head as OBJ with a material library, and a landmark file."""
    uv, face_uv = _uv(other)
    lines = ["mtllib head.mtl", *(f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in other.mesh.vertices)]
    lines += [f"vt {u:.7f} {v:.7f}" for u, v in uv] + ["usemtl skin"]
    for face, places in zip(other.mesh.faces + 1, face_uv + 1, strict=True):
        lines.append("f " + " ".join(f"{a}/{b}" for a, b in zip(face, places, strict=True)))
    mesh = folder / "head.obj"
    marks = folder / "head.json"
    mesh.write_text("\n".join(lines))
    (folder / "head.mtl").write_text(f"newmtl skin\nKd 1 1 1\nmap_Kd {picture}\n")
    marks.write_text(json.dumps(other.landmarks.tolist()))
    return mesh, marks


def _write_glb(folder, other):
    """Write the same head as GLB, whose vertices are doubled along the seam."""
    uv, face_uv = _uv(other)
    corners, numbers = np.unique(face_uv, return_inverse=True)
    vertices = np.vstack([other.mesh.vertices] * 2)[corners]
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=_striped())
    visual = trimesh.visual.TextureVisuals(uv=uv[corners], material=material)
    faces = numbers.reshape(-1, 3)
    mesh = folder / "head.glb"
    marks = folder / "head.json"
    mesh.write_bytes(
        trimesh.Trimesh(vertices, faces, process=False, visual=visual).export(file_type="glb")
    )
    original = corners % len(other.mesh.vertices)  # vertex of the head, for each vertex of the file
    of_landmarks = [int(np.flatnonzero(original == vertex)[0]) for vertex in other.landmarks]
    marks.write_text(json.dumps(of_landmarks))
    return mesh, marks


def _colours(head):
    """The picture's colours at the middles of the head's triangles."""
    return sampled(head.albedo, head.uv[head.face_uv].astype(np.float64).mean(axis=1))


def _of_file(other, fitted):
    """For each triangle of a fitted head its number in the file; fading triangles come last."""
    numbers = {frozenset(face): n for n, face in enumerate(other.mesh.faces.tolist())}
    return [numbers[frozenset(face)] for face in fitted.file_vertices[fitted.faces].tolist()]


@pytest.mark.slow
@pytest.mark.parametrize("write", [_write_obj, _write_glb])
def test_own_picture_lies_where_the_file_has_it(write, other, tmp_path):
    """Each triangle has the colour of its place; the form is one piece across the seam."""
    files = write(tmp_path, other)
    _striped().save(tmp_path / "skin.png")
    head = fit_head(*files)
    plain = fit(other.mesh, other.landmarks)
    assert head.albedo.shape == (SIZE, SIZE, 3)
    assert head.ambient_occlusion.shape == (SIZE, SIZE)
    assert len(head.vertices) == len(plain.vertices)
    assert np.allclose(head.vertices[head.faces], plain.vertices[plain.faces], atol=1e-3)
    uv, face_uv = _uv(other)
    wanted = uv[face_uv[_of_file(other, plain)]].mean(axis=1) * 256.0
    assert np.abs(_colours(head)[:, :2] - wanted).max() < 10.0
    refiner = refine.create("kahler", head.faces, head.vertices, head.uv, head.face_uv)
    sound_frame(refiner, head.vertices)


@pytest.mark.slow
def test_maps_go_along_to_the_own_layout(other, tmp_path):
    """For any layout of a mesh, maps of lips lie on lips and furrows on furrows."""
    files = _write_obj(tmp_path, other)
    _striped().save(tmp_path / "skin.png")
    head = fit_head(*files)
    plain = fit(other.mesh, other.landmarks)
    for of_head, of_plain in (
        (head.segments, plain.segments),
        (head.wrinkles.map[..., 2], plain.wrinkles.map[..., 2]),
    ):
        own, theirs = (
            sampled(each, layout.uv[layout.face_uv].astype(np.float64).mean(axis=1))
            for each, layout in ((of_head, head), (of_plain, plain))
        )
        assert (abs(own.astype(int) - theirs) <= 25).mean() > 0.95
        assert len(np.unique(own)) > 5


@pytest.mark.slow
def test_maps_turn_with_the_layout(head):
    """In a layout rotated by 90 degrees and half as large, slopes are rotated and doubled."""
    smooth = ndimage.gaussian_filter(head.wrinkles.map.astype(np.float64), (12.0, 12.0, 0.0))
    known = replace(assets.load("head"))  # a copy, whose map is replaced
    vars(known)["wrinkles"] = replace(head.wrinkles, map=smooth.round().astype(np.uint8))
    theirs = TextureLayout(known.uv, known.face_uv)
    turned = 0.5 * np.column_stack([-known.uv[:, 1], known.uv[:, 0]]) + [0.5, 0.0]
    own = TextureLayout(turned.astype(np.float32), known.face_uv)
    wrinkles, _, light = maps_in(known, theirs, own)
    place = known.uv[known.face_uv].mean(axis=1).astype(np.float64)
    image = turned[known.face_uv].mean(axis=1)

    def slopes(shape, where):
        return (sampled(shape.map, where)[:, :2] - 128.0) * (shape.steepest / 127.0)

    before = slopes(known.wrinkles, place)
    after = slopes(wrinkles, image)
    dark = sampled(known.ambient_occlusion, place).astype(int)
    found = sampled(light, image).astype(int)
    assert np.median(abs(found - dark)) < 3
    assert (dark < 128).sum() > 50 < (found < 128).sum()
    wanted = 2.0 * np.column_stack([-before[:, 1], before[:, 0]])
    is_within = (abs(wanted) < 0.9 * wrinkles.steepest).all(axis=1)
    assert np.median(abs(after - wanted)[is_within].max(axis=1)) < 0.05 * wrinkles.steepest
    assert np.corrcoef(after[is_within].ravel(), wanted[is_within].ravel())[0, 1] > 0.9


@pytest.mark.slow
def test_vertex_colours_are_drawn(other, tmp_path):
    """Vertex colours of a PLY file are drawn: red on the right half, blue on the left."""
    is_left = other.mesh.vertices[:, 0] > np.median(other.mesh.vertices[:, 0])
    colours = np.where(is_left[:, None], (20, 20, 220), (220, 20, 20)).astype(np.uint8)
    mesh = tmp_path / "head.ply"
    mesh.write_bytes(
        trimesh.Trimesh(
            other.mesh.vertices, other.mesh.faces, vertex_colors=colours, process=False
        ).export(file_type="ply")
    )
    marks = tmp_path / "head.json"
    marks.write_text(json.dumps(other.landmarks.tolist()))
    head = fit_head(mesh, marks)
    found = _colours(head).astype(float)
    of_face = is_left[other.mesh.faces[_of_file(other, head)]]
    assert (found[of_face.all(axis=1)] @ [-1, 0, 1] > 100).mean() > 0.95
    assert (found[~of_face.any(axis=1)] @ [-1, 0, 1] < -100).mean() > 0.95


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("skin.png", b"no picture", "its picture skin.png: is broken, too large, or neither"),
        ("skin.png", None, "its picture skin.png: no such picture file"),
        ("../skin.png", None, "names the file '../skin.png'; it must lie in the mesh's folder"),
        ("/etc/passwd", None, "names the file '/etc/passwd'; it must lie in the mesh's folder"),
        (r"C:\skin.png", None, "it must lie in the mesh's folder"),
    ],
)
def test_pictures_that_cannot_be_used_are_refused(name, content, message, other, tmp_path):
    """A picture that is broken, missing, or outside the folder is refused in one line."""
    files = _write_obj(tmp_path, other, name)
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(AssetError, match=message.replace("\\", "\\\\")) as raised:
        fit_head(*files)
    assert "\n" not in str(raised.value)


def test_a_link_out_of_the_folder_is_refused(other, tmp_path):
    """A link to a file outside the folder is refused by its target."""
    folder = tmp_path / "inside"
    folder.mkdir()
    _striped().save(tmp_path / "secret.png")
    (folder / "skin.png").symlink_to(tmp_path / "secret.png")
    with pytest.raises(AssetError, match="must lie in the mesh's folder"):
        fit_head(*_write_obj(folder, other))


def test_huge_pictures_are_refused_before_they_unfold(other, tmp_path):
    """A header that claims more pixels than fit into memory is refused before decoding."""
    files = _write_obj(tmp_path, other)
    whole = io.BytesIO()
    PIL.Image.new("L", (4, 4)).save(whole, "PNG")
    content = bytearray(whole.getvalue())
    content[16:24] = (60_000).to_bytes(4, "big") * 2
    (tmp_path / "skin.png").write_bytes(content)
    with pytest.raises(AssetError, match=r"its picture skin\.png: "):
        fit_head(*files)


@pytest.mark.slow
def test_a_missing_library_paints_nothing(other, tmp_path):
    """A missing library, as in many files, is reported in one line, and paints nothing."""
    files = _write_obj(tmp_path, other)
    (tmp_path / "head.mtl").unlink()
    assert read_mesh(files[0]).texture is None
    (note,) = fit_head(*files).notes
    assert "head.mtl is missing" in note


def test_layouts_that_cover_a_picture_many_times_are_refused():
    """Layouts that cover a picture many times are refused, because they would take hours."""
    uv = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], np.float32)
    layout = TextureLayout(uv, np.tile(np.arange(3, dtype=np.int32), (100_000, 1)))
    with pytest.raises(AssetError, match="many times over"):
        texels_within(layout, (1024, 1024))


def test_pictures_are_drawn_from_one_layout_to_another():
    """A picture redrawn to a mirrored layout and back is unchanged."""
    picture = np.asarray(_striped())
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    upright = TextureLayout(square, faces)
    mirrored = TextureLayout(square[[1, 0, 3, 2]], faces)
    once = drawn_over(picture, mirrored, (picture, upright))
    assert np.array_equal(once, picture[:, ::-1])
    assert np.array_equal(drawn_over(once, mirrored, (once, upright)), picture)


@pytest.mark.slow
def test_dense_heads_are_simplified_with_their_colours():
    """A head above the limit is simplified, and keeps its form, openings and colours.

    A line reports the simplification.
    """
    dense = user_head(2)
    vertices, faces = trimesh.remesh.subdivide(dense.mesh.vertices, dense.mesh.faces)
    colours = np.where(vertices[:, [0]] > dense.mesh.vertices[:, 0].mean(), 250, 10)
    mesh = Mesh(vertices, faces.astype(np.int32), colours=np.tile(colours, 3).astype(np.uint8))
    head = fit(mesh, dense.landmarks)
    assert head.simplified is not None
    assert len(head.simplified.faces) <= 15_000 < 20_000 < len(faces) == len(head.faces)
    assert "simplified" in head.notes[0]
    off = head.to_millimetres.points(vertices[dense.landmarks]) - head.vertices[head.landmarks]
    assert np.linalg.norm(off, axis=1).max() < 1e-6
    is_right = head.vertices[head.faces, 0].mean(axis=1) < 0.0  # the file's x axis is reversed
    assert ((_colours(head)[:, 0] > 128) == is_right).mean() > 0.95
