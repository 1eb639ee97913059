"""The generator still makes the head that is shipped."""

import errno
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from risorius.assets import build
from risorius.assets.loading import HEAD_FILE, load, load_head

# Processors round differently; nobody could see so little.
TOLERANCE = 1e-3  # [mm]
PART_OF_TEXEL = 1e-4  # of the picture's side: an eighth of a texel
LEVELS = 0.05  # of 255, mean over a picture
Arrays = Mapping[str, npt.NDArray[np.generic]]


@pytest.fixture(scope="module")
def shipped() -> Arrays:
    """What the data file holds."""
    with np.load(HEAD_FILE) as file:
        return {name: file[name] for name in file.files}


@pytest.fixture(scope="module")
def rebuilt(tmp_path_factory: pytest.TempPathFactory, shipped: Arrays) -> Path:
    """All that is made from the shipped mesh and its layout, made now, by the command itself."""
    path = tmp_path_factory.mktemp("head") / "head.npz"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "build_head", lambda: shipped)
        build.main([str(path)])
    return path


@pytest.mark.slow
def test_rebuilt_head_is_the_shipped_one(shipped: Arrays) -> None:
    """Every array: integers and names exactly, coordinates within the tolerance."""
    fresh = build.build_head()
    assert sorted(fresh) == sorted(shipped)
    for name, array in fresh.items():
        if np.issubdtype(array.dtype, np.floating):
            tolerance = PART_OF_TEXEL if name == "uv" else TOLERANCE
            np.testing.assert_allclose(array, shipped[name], atol=tolerance, err_msg=name)
        else:
            assert np.array_equal(array, shipped[name]), name


@pytest.mark.slow
def test_rebuilt_head_can_be_loaded(rebuilt: Path) -> None:
    """What build writes, load reads."""
    assert len(load_head(rebuilt).faces) == 2030


@pytest.mark.slow
def test_rebuilt_finer_meshes_are_the_shipped_ones(rebuilt: Path) -> None:
    """New vertices within the tolerance; normals are of half precision."""
    with (
        np.load(load_head(rebuilt).finer_file) as fresh,
        np.load(load("head").finer_file) as shipped,
    ):
        assert sorted(fresh.files) == sorted(shipped.files)
        assert np.allclose(fresh["added_vertices"], shipped["added_vertices"], atol=TOLERANCE)
        assert np.allclose(fresh["normals"], shipped["normals"], atol=0.02)
    assert len(load_head(rebuilt).finer(2).faces) == 16 * 2030


@pytest.mark.slow
def test_repainted_skin_is_the_shipped_one(rebuilt: Path) -> None:
    """The picture beside the data file comes from the same command."""
    fresh, shipped = load_head(rebuilt).albedo.astype(int), load("head").albedo.astype(int)
    assert fresh.shape == shipped.shape
    difference = np.abs(fresh - shipped)
    assert difference.mean() < LEVELS and (difference > 8).mean() < 0.001


@pytest.mark.slow
def test_repainted_wrinkles_are_the_shipped_ones(rebuilt: Path) -> None:
    """The map to a few texels of rounding, and the directions of all vertices."""
    fresh, shipped = load_head(rebuilt).wrinkles, load("head").wrinkles
    assert fresh.steepest == shipped.steepest
    difference = np.abs(fresh.map.astype(int) - shipped.map.astype(int))
    assert difference.mean() < LEVELS and (difference > 8).mean() < 0.001
    assert np.allclose(fresh.across, shipped.across, atol=1e-4)


@pytest.mark.slow
def test_repainted_tints_are_the_shipped_ones(rebuilt: Path) -> None:
    """The maps with which skin takes on another tone, to a hundredth or two of rounding."""
    with (
        np.load(load_head(rebuilt).tints_file) as fresh,
        np.load(load("head").tints_file) as shipped,
    ):
        assert {*fresh.files} == {*shipped.files} - {"tone"}  # which nobody reads
        for name in ("melanin", "blood", "hair"):
            difference = np.abs(fresh[name].astype(int) - shipped[name].astype(int))
            assert difference.mean() < LEVELS and (difference > 4).mean() < 0.001, name
        assert np.allclose(fresh["skin"], shipped["skin"], atol=1e-3)


@pytest.mark.slow
def test_repainted_segments_are_the_shipped_ones(rebuilt: Path) -> None:
    """But for a few texels on borders, which rounding may move."""
    fresh, shipped = load_head(rebuilt).segments, load("head").segments
    assert fresh.shape == shipped.shape and (fresh != shipped).mean() < 1e-4


@pytest.mark.slow
def test_size_is_an_option(
    tmp_path: Path, shipped: Arrays, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A skin of 96 texels on request; light that was baked for another is gone."""
    monkeypatch.setattr(build, "build_head", lambda: shipped)
    light = tmp_path / "small_ambient_occlusion.npz"
    light.write_bytes(b"baked for a larger picture")
    build.main([str(tmp_path / "small.npz"), "--size", "96"])
    image = load_head(tmp_path / "small.npz").albedo
    assert image.shape == (96, 96, 3) and not light.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="paths of POSIX systems")
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["/proc/none/head.npz"], "assets.build: /proc/none: No such file or directory\n"),
        (["{folder}"], "assets.build: {folder}: is a folder; name a file\n"),
        (["{folder}/head.npz", "--size", "0"], "'0' is no size; write 64 to 8192\n"),
    ],
)
def test_mistakes_are_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    """Where nothing can be written it is told before anything is built; nothing is left."""
    with pytest.raises(SystemExit) as ended:
        build.run([word.format(folder=tmp_path) for word in words])
    assert ended.value.code == 2
    assert capsys.readouterr().err.endswith(told.format(folder=tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_leaves_the_files_that_were_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An error in the middle of building: one line, the old file untouched, nothing beside it."""
    path = tmp_path / "head.npz"
    path.write_bytes(b"precious")

    def full(file: Path, size: int) -> None:
        file.write_bytes(b"half of")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(build, "_write", full)
    with pytest.raises(SystemExit) as ended:
        build.run([str(path)])
    assert ended.value.code == 2
    assert capsys.readouterr().err == "assets.build: No space left on device\n"
    assert path.read_bytes() == b"precious" and list(tmp_path.iterdir()) == [path]
