"""Loading: the promises of `assets.load`, and its messages when a file fails."""

import shutil
import subprocess
import sys
import zlib

import numpy as np
import pytest

from risorius import assets
from risorius.assets import AssetError, loading
from risorius.assets.fitting.painting import plain_picture
from risorius.assets.loading import HEAD_FILE, load_head
from risorius.geometry.normals import cross_products
from tests.tracked import tracked

MOST_DATA = 3_600_000  # [bytes] of all data files; a quarter of it is the painted skin


def test_unknown_name_is_refused_with_the_known_ones():
    """An unknown name is refused, and the message has the known names."""
    with pytest.raises(AssetError, match=r"'haed'; available: head, plane; a mesh file is"):
        assets.load("haed")


def test_plane_is_that_of_the_paper():
    """The plane of Figure 9: 7 x 11 cells, 154 triangles, flat, all facing the viewer."""
    plane = assets.load("plane")
    cross = cross_products(plane.vertices, plane.faces)
    assert plane.vertices.shape == (96, 3)
    assert plane.faces.shape == (154, 3)
    assert np.allclose(plane.vertices.mean(axis=0), 0.0)
    assert np.allclose(cross, [0.0, 0.0, 100.0])


def test_types_and_shapes_are_those_of_the_docstrings(head):
    """Types and shapes are as documented, because other packages rely on them unchecked."""
    count = len(head.vertices)
    for array, kind, shape in (
        (head.vertices, np.float64, (count, 3)),
        (head.faces, np.int32, (2030, 3)),
        (head.landmarks, np.int32, (68,)),
        (head.bone_depth, np.float64, (count,)),
        (head.mandible_weight, np.float64, (count,)),
        (head.jaw_axis, np.float64, (2, 3)),
    ):
        assert array.dtype == kind
        assert array.shape == shape
    assert [eye.name for eye in head.eyes] == ["right", "left"]
    assert isinstance(head.rig, dict)
    assert len(head.layers) == 4


READS_FILE = {
    "head.npz": lambda head: head.vertices,
    "head.png": lambda head: head.albedo,
    "head_fine_shape.npz": lambda head: head.fine_shape,
    "head_ambient_occlusion.npz": lambda head: head.ambient_occlusion,
    "head_plain.npz": plain_picture,
    "head_finer.npz": lambda head: head.finer(1),
    "head_segments.png": lambda head: head.segments,
    "head_wrinkles.npz": lambda head: head.wrinkles,
}


@pytest.mark.parametrize("name", READS_FILE)
def test_missing_and_broken_files_are_reported_when_they_are_needed(name, tmp_path):
    """Missing and broken files are reported when they are needed, with the remedy.

    Neither garbage nor half a file gives a library's traceback.
    """
    folder = shutil.copytree(HEAD_FILE.parent, tmp_path / "data", symlinks=True)
    whole = (folder / name).read_bytes()
    for content in (b"nothing", whole[:5000], b""):
        (folder / name).write_bytes(content)
        with pytest.raises(AssetError, match=rf"{name} cannot be read .*; install risorius again"):
            READS_FILE[name](load_head(folder / "head.npz"))
    (folder / name).unlink()
    if name != "head.npz":
        load_head(folder / "head.npz")  # enough for a simulation
    with pytest.raises(AssetError, match=rf"{name} cannot be read \(.*No such file.*; install"):
        READS_FILE[name](load_head(folder / "head.npz"))


def test_files_are_made_from_this_head(head):
    """Maps that belong to a head were made from its mesh."""
    own = zlib.crc32(head.faces.tobytes(), zlib.crc32(head.vertices.tobytes()))
    found = [np.load(file).get("made_from") for file in tracked("assets/data", "head_*.npz")]
    assert found == len(found) * [own]
    assert len(found) > 4


def test_broken_text_files_are_reported(tmp_path, monkeypatch):
    """A broken rig is an error that names the file."""
    broken = tmp_path / "rig.toml"
    broken.write_text("[muscle\n", encoding="utf-8")
    monkeypatch.setattr(loading, "RIG_FILE", broken)
    with pytest.raises(AssetError, match=r"rig\.toml cannot be read"):
        load_head()


def test_layers_arrive_as_written(tmp_path, monkeypatch):
    """A table of expressions keeps its rows, and its file name for error messages."""
    file = tmp_path / "expressions.toml"
    file.write_text("[smile]\nzygomaticus_major_left = 0.8\n", encoding="utf-8")
    monkeypatch.setattr(loading, "LAYER_FILES", {"Expressions": file})
    head = load_head()
    assert head.expressions == {"smile": {"zygomaticus_major_left": 0.8}}
    assert [(layer.title, layer.source) for layer in head.layers] == [
        ("Expressions", "expressions.toml")
    ]


def test_data_stay_small():
    """All data files together stay below the limit, so that the package stays small."""
    assert sum(file.stat().st_size for file in tracked("assets/data")) < MOST_DATA


def test_loading_is_light():
    """Loading needs neither SciPy, as fits and persons do, nor a picture, so it stays fast."""
    code = (
        "import sys; from risorius import assets; assets.load('head');"
        "assert not any(name.startswith(('scipy', 'PIL')) for name in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
