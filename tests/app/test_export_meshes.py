"""Exported meshes, read by readers of other projects, and compared in millimetres."""

import re
import struct
import zipfile

import h5py
import numpy as np
import PIL.Image
import pytest
import trimesh
from numpy.linalg import norm
from pxr import Tf, Usd, UsdGeom, UsdShade
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from risorius.app.export.clip import Clip, record
from risorius.app.export.formats import ExportRequest, format_for, write
from risorius.app.refining.presets import Refinement
from risorius.app.scenes import FaceScene
from risorius.app.script.script_file import parse_script
from risorius.geometry.transforms import moved_points

from .command_line import positions_in_blender

RATE = 24.0  # frames per second
FRAME_COUNT = 8
TOLERANCE = 1e-3  # [mm], error of single precision at a head's size
METRES_PER_MILLIMETRE = 0.001
SCRIPT = """
duration = 0.3
[[pose]]
time = 0.0
[[pose]]
time = 0.3
joy = 1.0
jaw_open = 0.5
tongue_out = 0.6
gaze_horizontal = 0.5
head_yaw = 0.4
"""
DEFAULT_REFINEMENT = Refinement()


@pytest.fixture(scope="module")
def clip() -> Clip:
    """A face that moves all its parts."""
    return record(parse_script(SCRIPT, source="test"), FaceScene(), RATE, progress=False)


def written(clip, path, name=None, refinement=None):
    """Write a clip to a file."""
    write(clip, path, format_for(path, name), ExportRequest(refinement, progress=False))
    return path


def whole(clip, frame):
    """All vertices of a frame [mm], beginning with the skin."""
    return np.concatenate([each.at(frame) for each in clip.surfaces])


def refined_skins(clip):
    """Points and triangles of the refined skin in each frame."""
    meshes = clip.refined(DEFAULT_REFINEMENT)
    return [(mesh.positions.astype(float), mesh.triangles.copy()) for mesh in meshes]


def is_near(found, wanted, unit=1.0):
    """Whether points equal the wanted ones in order; unit: metres per unit of the points."""
    points = np.asarray(found, np.float64) / unit
    return points.shape == wanted.shape and np.abs(points - wanted).max() < TOLERANCE


# ---------- USD ---------------------------------------------------------------------------------


def usd_points(stage, name, frame):
    """Points of a mesh in a USD stage [mm]."""
    prim = stage.GetPrimAtPath(f"/face/{name}")
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(frame), np.float64)
    matrix = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(frame))
    return points @ matrix[:3, :3] + matrix[3, :3]


def test_usd_has_every_surface_in_every_frame(clip, tmp_path):
    """The stage has the right rate, unit, axis and frames; points are exact to 0.001 mm."""
    stage = Usd.Stage.Open(str(written(clip, tmp_path / "face.usdz")))
    assert stage.GetTimeCodesPerSecond() == stage.GetFramesPerSecond() == RATE
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, FRAME_COUNT - 1)
    assert UsdGeom.GetStageMetersPerUnit(stage) == METRES_PER_MILLIMETRE
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    for surface in clip.surfaces:
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath(f"/face/{surface.name}"))
        assert mesh.GetSubdivisionSchemeAttr().Get() == UsdGeom.Tokens.none
        indices = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
        assert np.array_equal(indices, surface.faces)
        for frame in range(FRAME_COUNT):
            assert is_near(usd_points(stage, surface.name, frame), surface.at(frame))
            low, high = np.array(mesh.GetExtentAttr().Get(frame))
            points = np.array(mesh.GetPointsAttr().Get(frame))
            assert np.array_equal([low, high], [points.min(axis=0), points.max(axis=0)])


def test_usd_has_the_texture_and_colours(clip, tmp_path):
    """The package has texture coordinates of each corner, the picture, and linear part colours."""
    path = written(clip, tmp_path / "face.usdz")
    stage = Usd.Stage.Open(str(path))
    skin = stage.GetPrimAtPath("/face/skin")
    st = UsdGeom.PrimvarsAPI(skin).GetPrimvar("st")
    assert np.array_equal(np.array(st.ComputeFlattened()), clip.skin.uv[clip.skin.face_uv.ravel()])
    material, _ = UsdShade.MaterialBindingAPI(skin).ComputeBoundMaterial()
    texture = UsdShade.Shader(stage.GetPrimAtPath(f"{material.GetPath()}/texture"))
    assert texture.GetInput("file").Get().resolvedPath == f"{path}[skin.png]"
    with zipfile.ZipFile(path) as package, package.open("skin.png") as picture:
        assert np.array_equal(np.asarray(PIL.Image.open(picture)), clip.scene.skin.albedo)
    colours = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/face/eyeball_left")).GetPrimvar(
        "displayColor"
    )
    eye = next(each for each in clip.surfaces if each.name == "eyeball_left")
    assert eye.colours is not None
    light = np.array(colours.Get())
    screen = np.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    assert np.abs(screen - eye.colours).max() < 1e-4


def test_usd_is_sound(clip, tmp_path):
    """Pixar's validators report nothing about the package."""
    validation = pytest.importorskip("pxr.UsdValidation")
    try:
        validators = validation.ValidationRegistry().GetOrLoadAllValidators()
    except Tf.ErrorException:
        pytest.skip("this release of usd-core came without its validators")
    stage = Usd.Stage.Open(str(written(clip, tmp_path / "face.usdz")))
    errors = validation.ValidationContext(validators).Validate(stage)
    assert len(validators) > 10
    assert not [error.GetMessage() for error in errors]


def test_usd_has_the_refined_skin(clip, tmp_path):
    """Each frame has its own triangles, with normals and texture coordinates for every point."""
    path = written(clip, tmp_path / "fine.usdz", refinement=DEFAULT_REFINEMENT)
    stage = Usd.Stage.Open(str(path))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/face/skin"))
    counts = set()
    for frame, (points, triangles) in enumerate(refined_skins(clip)):
        indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(frame)).reshape(-1, 3)
        assert np.array_equal(indices, triangles)
        assert len(mesh.GetFaceVertexCountsAttr().Get(frame)) == len(triangles)
        assert is_near(usd_points(stage, "skin", frame), points)
        lengths = norm(np.array(mesh.GetNormalsAttr().Get(frame)), axis=1)
        assert lengths.shape == points.shape[:1]
        assert np.allclose(lengths, 1.0, atol=1e-4)
        st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st").Get(frame)
        assert len(st) == len(points)
        counts.add(len(points))
    assert len(counts) > 1
    assert min(counts) > len(clip.skin.rest)


# ---------- VTKHDF ------------------------------------------------------------------------------


def vtk_steps(path):
    """Time and PolyData of each step, as read by VTK."""
    reader = vtkHDFReader()
    steps = []
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    information = reader.GetOutputInformation(0)
    for step in range(information.Length(times)):
        time = information.Get(times, step)
        reader.UpdateTimeStep(time)
        copy = reader.GetOutputDataObject(0).NewInstance()
        copy.DeepCopy(reader.GetOutputDataObject(0))
        steps.append((time, copy))
    return steps


def test_vtkhdf_has_every_frame(clip, tmp_path):
    """VTK reads times, points, triangles and attributes; the triangles are stored once."""
    path = written(clip, tmp_path / "face.vtkhdf")
    steps = vtk_steps(path)
    assert np.allclose([time for time, _ in steps], np.arange(FRAME_COUNT) / RATE)
    rest = np.concatenate([each.rest for each in clip.surfaces])
    for frame, (_, data) in enumerate(steps):
        points = vtk_to_numpy(data.GetPoints().GetData())
        assert is_near(points, whole(clip, frame))
        lengths = norm(vtk_to_numpy(data.GetPointData().GetArray("Normals")), axis=1)
        assert np.allclose(lengths, 1.0, atol=1e-5)
        if vtkVersion().GetVTKVersion() >= "9.5":  # from this version on, VTK's lighting uses it
            assert data.GetPointData().GetNormals() is not None
        moved = vtk_to_numpy(data.GetPointData().GetArray("displacement"))
        assert np.abs(moved - (whole(clip, frame) - rest)).max() < TOLERANCE
        corners = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        surface = vtk_to_numpy(data.GetCellData().GetArray("surface"))
        start = 0
        for number, each in enumerate(clip.surfaces):
            assert np.array_equal(corners[surface == number] - start, each.faces)
            start += len(each.rest)
    with h5py.File(path) as file:
        triangles = sum(len(each.faces) for each in clip.surfaces)
        assert len(file["VTKHDF/Polygons/Connectivity"]) == 3 * triangles
        assert list(file["VTKHDF"].attrs["surfaces"]) == [each.name for each in clip.surfaces]


# ---------- Point caches ------------------------------------------------------------------------


def obj_rows(path, name):
    """The numbers in all lines of one kind in an OBJ file."""
    lines = path.read_text().splitlines()
    return np.array([line.split()[1:] for line in lines if line.startswith(f"{name} ")], float)


def test_pc2_moves_the_mesh_beside_it(clip, tmp_path):
    """A PC2 file has a header of 32 bytes, then little-endian floats in metres, as published."""
    data = written(clip, tmp_path / "face.pc2").read_bytes()
    head = struct.unpack("<12siiffi", data[:32])
    vertices = len(whole(clip, 0))
    assert head == (b"POINTCACHE2\0", 1, vertices, 0.0, 1.0, FRAME_COUNT)
    points = np.frombuffer(data[32:], "<f4").reshape(FRAME_COUNT, vertices, 3)
    for frame in range(FRAME_COUNT):
        assert is_near(points[frame], whole(clip, frame), METRES_PER_MILLIMETRE)
    assert is_near(
        obj_rows(tmp_path / "face.obj", "v")[:, :3], whole(clip, 0), METRES_PER_MILLIMETRE
    )
    assert sorted(each.name for each in tmp_path.iterdir()) == [
        *("face.mtl", "face.obj", "face.pc2", "face_skin.png"),
    ]


# ---------- Sequences ---------------------------------------------------------------------------


def triangles_in(path):
    """Corners and normals of all triangles in an OBJ file, in order, shape (F, 3, 3)."""
    lines = [line for line in path.read_text().splitlines() if line.startswith("f ")]
    cells = re.findall(r"(\d+)/\d*/(\d+)", "\n".join(lines))
    vertices, normals = np.array(cells, int).reshape(-1, 3, 2).transpose(2, 0, 1) - 1
    return obj_rows(path, "v")[vertices, :3], obj_rows(path, "vn")[normals]


@pytest.mark.slow
@pytest.mark.parametrize("refinement", [None, DEFAULT_REFINEMENT], ids=["mesh", "refined"])
def test_sequences_have_every_frame(clip, tmp_path, refinement):
    """Frames are numbered in order; triangles are those of the clip, lit from outside."""
    folder = written(clip, tmp_path / "frames", "obj", refinement)
    meshes = sorted(folder.glob("*.obj"))
    assert [each.stem for each in meshes] == [f"frame_{n:05d}" for n in range(FRAME_COUNT)]
    skins = None if refinement is None else refined_skins(clip)
    for frame, path in enumerate(meshes):
        wanted = [each.at(frame)[each.faces] for each in clip.surfaces]
        if skins is not None:
            points, triangles = skins[frame]
            wanted[0] = points[triangles]
        corners, normals = triangles_in(path)
        assert is_near(corners, np.concatenate(wanted), METRES_PER_MILLIMETRE)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert np.mean((normals.mean(axis=1) * across).sum(axis=1) >= 0.0) > 0.99
    assert np.allclose(
        trimesh.load_mesh(meshes[-1]).bounds, [corners.min(axis=(0, 1)), corners.max(axis=(0, 1))]
    )


def test_an_obj_keeps_the_vertices_of_the_mesh(clip, tmp_path):
    """An OBJ file has V vertices in order, with colours, and a group for each part.

    Texture coordinates have their own numbers.
    """
    folder = written(clip, tmp_path / "frames", "obj")
    path = folder / f"frame_{FRAME_COUNT - 1:05d}.obj"
    rows = obj_rows(path, "v")
    assert is_near(rows[:, :3], whole(clip, FRAME_COUNT - 1), METRES_PER_MILLIMETRE)
    assert rows.shape[1] == 6
    assert rows[:, 3:].min() >= 0.0
    assert rows[:, 3:].max() <= 1.0
    assert clip.skin.uv is not None
    assert np.allclose(obj_rows(path, "vt")[: len(clip.skin.uv)], clip.skin.uv, atol=1e-5)
    text = path.read_text()
    groups = [line[2:] for line in text.splitlines() if line.startswith("g ")]
    assert groups == [each.name for each in clip.surfaces]
    assert "mtllib frame.mtl" in text
    assert "frame_skin.png" in (folder / "frame.mtl").read_text()
    assert (folder / "frame_skin.png").is_file()


# ---------- Arrays, other scenes, Blender -------------------------------------------------------


def test_npz_has_all_of_a_clip(clip, tmp_path):
    """The arrays alone are enough to rebuild every surface."""
    with np.load(written(clip, tmp_path / "face.npz")) as arrays:
        assert np.array_equal(arrays["positions"], clip.skin.shapes)
        assert np.array_equal(arrays["times"], clip.times)
        assert float(arrays["frames_per_second"]) == RATE
        for surface in clip.surfaces[1:]:
            part = f"parts/{surface.name}"
            rest = arrays[f"{part}/rest_positions"]
            shapes = (
                arrays[f"{part}/shapes"] if f"{part}/shapes" in arrays else [rest] * FRAME_COUNT
            )
            for frame, matrix in enumerate(arrays[f"{part}/matrices"]):
                points = moved_points(matrix, shapes[frame])
                assert is_near(points, surface.at(frame))
            assert np.array_equal(arrays[f"{part}/faces"], surface.faces)
        assert set(arrays) >= {"uv", "face_uv", "bones/mandible", "controls/joy"}
        assert np.array_equal(arrays["activations/jaw_open"], clip.activations["jaw_open"])


@pytest.mark.blender
@pytest.mark.parametrize("name", ["face.usdz", "fine.usdz", "face.pc2"])
def test_blender_sees_the_same(clip, tmp_path, name):
    """Blender imports the file, and has each vertex at its place in every frame."""
    is_fine = name.startswith("fine")
    path = written(clip, tmp_path / name, refinement=DEFAULT_REFINEMENT if is_fine else None)
    found = positions_in_blender(path, tmp_path, RATE, FRAME_COUNT)
    with np.load(found) as positions:
        for frame in range(FRAME_COUNT):
            if name.endswith("pc2"):
                assert is_near(positions["face"][frame], whole(clip, frame), METRES_PER_MILLIMETRE)
                continue
            for surface in clip.surfaces[is_fine:]:
                assert is_near(
                    positions[surface.name][frame], surface.at(frame), METRES_PER_MILLIMETRE
                )
            if is_fine:
                assert is_near(
                    positions[f"skin/{frame}"], refined_skins(clip)[frame][0], METRES_PER_MILLIMETRE
                )
