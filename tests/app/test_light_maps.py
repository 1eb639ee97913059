"""Light maps from files: Radiance HDR, OpenEXR, and refused files."""

import gc
import json
import shutil
import tracemalloc
import weakref
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_allclose

from risorius import render
from risorius.app import light_maps
from risorius.app.dataset import surroundings
from risorius.app.errors import UserError
from risorius.app.light_maps import check_light_map, read_light_map
from risorius.geometry.colour import to_screen

from .command_line import risorius, succeeded
from .light_files import HEADER, pixels, rgbe, write_map


def packed(lines):
    """RGBE rows compressed channel by channel, with equal values as a run."""
    found = b""
    for line in lines:
        found += bytes([2, 2, 0, len(line)])
        for channel in line.T.tolist():
            column = 0
            while column < len(channel):
                end = column
                while end < len(channel) and channel[end] == channel[column]:
                    end += 1
                if end - column > 2:
                    found += bytes([128 + end - column, channel[column]])
                else:
                    found += bytes([end - column, *channel[column:end]])
                column = end
    return found


def _write_openexr(path, size):
    """Write the upper left part of the sky, with an alpha channel."""
    module = pytest.importorskip("OpenEXR")
    rows, columns = size
    light = pixels()[:rows, :columns].astype(np.float32)
    channels = {name: light[..., k].copy() for k, name in enumerate("RGB")}
    channels["A"] = np.ones(size, np.float32)
    kind = {"compression": module.ZIP_COMPRESSION, "type": module.scanlineimage}
    with module.File(kind, channels) as file:
        file.write(str(path))


def _count_calls(monkeypatch, owner, name, count):
    """Call `count` with a function's arguments before each call of the function."""
    function = getattr(owner, name)

    def counted(*given, **named):
        count(*given, **named)
        return function(*given, **named)

    monkeypatch.setattr(owner, name, counted)


@pytest.mark.parametrize("is_packed", [True, False])
def test_radiance_is_read(tmp_path, is_packed):
    """Radiance files are read with and without runs, to the precision of their bytes."""
    path = tmp_path / "sky.hdr"
    content = rgbe(pixels())
    path.write_bytes(HEADER + (packed(content) if is_packed else content.tobytes()))
    found = read_light_map(path).radiance
    assert_allclose(found[::4, ::4], pixels(), rtol=0.05, atol=0.01)


def test_openexr_is_read(tmp_path):
    """Channels R, G and B are read, and all other channels are ignored."""
    path = tmp_path / "sky.exr"
    _write_openexr(path, (32, 64))
    assert_allclose(read_light_map(path).radiance[::4, ::4], pixels(), rtol=1e-3)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("sky.png", b"", "is not a light map; give a file .hdr or .exr"),
        ("sky.hdr", b"nothing", "cannot be read as a light map"),
        ("sky.hdr", HEADER + b"\2\2\0\x40" + b"\xff", "cannot be read as a light map"),
        ("sky.hdr", HEADER.replace(b"64", b"32") + bytes(32 * 32 * 4), "has 32 x 32 pixels"),
        (
            "sky.hdr",
            HEADER.replace(b"Y 32 +X 64", b"Y 32767 +X 65534"),
            "at most 32767 pixels wide",
        ),
        ("sky.hdr", HEADER.replace(b"Y 32 +X 64", b"Y 99999 +X 65535"), "has 65535 x 99999 pixels"),
        ("sky.hdr", HEADER.replace(b"Y 32 +X 64", b"Y 0 +X 0"), "has 0 x 0 pixels"),
        ("sky.hdr", HEADER + bytes(64 * 32 * 4), "is black"),
        ("sky.exr", b"nothing", "cannot be read as a light map"),
    ],
)
def test_others_are_refused_in_one_line(tmp_path, name, content, message):
    """Other files are refused in one line with the file's name and the allowed kinds."""
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(UserError, match=message) as raised:
        read_light_map(path)
    assert str(raised.value).startswith(str(path))


@pytest.mark.parametrize("size", ["Y 99999 +X 65535", "Y 16383 +X 32767"])
def test_a_header_reserves_no_memory(tmp_path, size):
    """A size that is wrong, or larger than the file, is refused before memory is reserved."""
    path = tmp_path / "sky.hdr"
    path.write_bytes(HEADER.replace(b"Y 32 +X 64", size.encode()))
    tracemalloc.start()
    with pytest.raises(UserError):
        read_light_map(path)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 2**29  # slightly more than the largest allowed file


def test_openexr_is_not_read_into_memory_first(tmp_path, monkeypatch):
    """Only the first bytes are read before the library reads the OpenEXR file."""
    path = tmp_path / "sky.exr"
    _write_openexr(path, (32, 64))
    read = []
    _count_calls(monkeypatch, light_maps, "read_bytes", lambda _, **named: read.append(named))
    read_light_map(path)
    assert [named["first"] for named in read] == [2**16]


def test_a_size_of_openexr_is_refused_by_its_header(tmp_path):
    """A wrong size in the header of an OpenEXR file is refused, as in a Radiance file."""
    path = tmp_path / "sky.exr"
    _write_openexr(path, (32, 32))
    with pytest.raises(UserError, match="has 32 x 32 pixels"):
        check_light_map(path)


def test_maps_of_the_window_leave_the_memory(tmp_path):
    """A map stays while few others are opened; after many others, only its file has it."""
    paths = [write_map(tmp_path / f"{number}.hdr") for number in range(40)]
    name = light_maps.open_light(paths[0])
    first = weakref.ref(light_maps.scene_light(name).behind)
    for path in paths[1:4]:
        light_maps.open_light(path)
    assert light_maps.scene_light(name).behind is first()
    for path in paths[4:]:
        light_maps.open_light(path)
    gc.collect()
    assert first() is None
    assert light_maps.scene_light(name).behind is not None


def test_a_changed_map_is_read_again(tmp_path):
    """Opened again, a map is read from its file; if the file is broken, its former light stays."""
    path = write_map(tmp_path / "sky.hdr")
    name = light_maps.open_light(path)
    first = light_maps.scene_light(name)
    path.write_bytes(HEADER + rgbe(pixels()[:, ::-1].copy()).tobytes())
    assert light_maps.scene_light(name) is first
    light_maps.open_light(path)
    second = light_maps.scene_light(name)
    assert second.light.to_key[0] * first.light.to_key[0] < 0.0  # the sun is at the other side
    path.write_bytes(HEADER)
    with pytest.raises(UserError, match=r"sky\.hdr"):
        light_maps.open_light(path)
    assert light_maps.scene_light(name) is second


@pytest.mark.slow
def test_maps_of_a_set_are_read_once(tmp_path, monkeypatch):
    """Each of 10 maps is read once for all samples; its light is computed once per sample."""
    for number in range(10):
        write_map(tmp_path / f"{number}.hdr")
    (tmp_path / "folder.hdr").mkdir()
    read = []
    exposed = []
    _count_calls(monkeypatch, surroundings, "read_light_map", read.append)
    _count_calls(monkeypatch, render.LightMap, "exposed", lambda *given: exposed.append(given))
    monkeypatch.chdir(tmp_path)
    files = surroundings.light_files_of(Path())
    random = np.random.default_rng(0)
    for _ in range(60):
        lit = surroundings.light_of("", files, random)
    lit.map.background(lit.turn, lit.exposure)
    assert sorted(read) == list(files.paths)
    assert len(read) == 10
    assert len(exposed) == 60


def test_every_map_of_a_folder_is_checked(tmp_path):
    """The header of every map in a folder is checked before any sample is drawn."""
    write_map(tmp_path / "a.hdr")
    (tmp_path / "b.hdr").write_bytes(b"nothing")
    with pytest.raises(UserError, match=r"b\.hdr: cannot be read as a light map"):
        surroundings.light_files_of(tmp_path)


@pytest.mark.slow
def test_a_set_is_lit_by_files(tmp_path):
    """A map from the folder lights each sample, rotated, and is its background.

    Labels report the map.
    """
    maps = tmp_path / "maps"
    maps.mkdir()
    write_map(maps / "sky.hdr")
    shutil.copy(maps / "sky.hdr", maps / "sun.hdr")
    options = ("--count", 1, "--size", "64x64", "--light", maps, "--quiet")
    succeeded("dataset", *options, "-o", tmp_path / "set")
    labels = json.loads((tmp_path / "set" / "000000.json").read_text())
    assert labels["light"]["name"] in ("sky.hdr", "sun.hdr")
    assert labels["background"] == labels["light"]["name"]
    assert -180.0 <= labels["light"]["turn"] <= 180.0
    assert len(labels["light"]["around"]) == 9


@pytest.fixture(scope="module")
def map_ahead():
    """A grey world with a dark spot behind the head, and white behind the viewer."""
    radiance = np.full((64, 128, 3), 0.3)
    radiance[28:36, 62:66] = 0.0
    radiance[:, :32] = 1.0
    return render.LightMap(radiance)


def _painted(background, lens=40.0):
    with render.open_offscreen((80, 60)) as surface:
        camera = render.OrbitCamera.framing(np.array([[-1.0] * 3, [1.0] * 3]))
        camera.field_of_view = lens
        frame = render.Frame(render.CameraView(camera), render.Style(background=background))
        render.Renderer(surface).draw(frame)
        return surface.read()[..., 0].astype(int)


def test_the_background_is_the_middle_of_the_map(map_ahead):
    """The middle of the map is behind the head, out of focus; it follows the map's rotation."""
    rows = [_painted(map_ahead.background(turn))[30] for turn in (0.0, 12.0)]
    assert abs(int(rows[0].argmin()) - 40) <= 3
    assert rows[1].argmin() > rows[0].argmin() + 8
    assert np.abs(np.diff(rows[0])).max() < 40


def test_a_longer_lens_shows_less_of_the_map(map_ahead):
    """A spot is twice as wide through a lens that shows half as much."""
    behind = map_ahead.background()
    widths = []
    for angle in (40.0, 20.6):
        row = _painted(behind, angle)[30]
        widths.append((row < row.max() - 20).sum())
    assert widths[1] == pytest.approx(2.0 * widths[0], abs=3)


def test_a_map_is_seen_as_bright_as_it_is(map_ahead):
    """A place of the map is as bright as its light, exposed and tone-mapped like the scene."""
    painted = _painted(map_ahead.background(exposure=2.0))
    assert_allclose(painted[5, 5], 255.0 * to_screen(0.6), atol=2)


@pytest.mark.parametrize("lit", ["file", "name"])
def test_capture_shows_the_map_behind(tmp_path, lit):
    """The map may be a file, or a built-in one by name; without one, a line asks for an option."""
    path = write_map(tmp_path / "sky.hdr")
    light = ("--style", f"light={path if lit == 'file' else 'room'}")
    light_map = read_light_map(path) if lit == "file" else render.LIGHT_MAPS["room"]
    options = ("--scene", "plane", "--size", "80x60", "--background", "map")
    succeeded("capture", *options, *light, "--quiet", "-o", tmp_path / "seen.png")
    seen = np.asarray(PIL.Image.open(tmp_path / "seen.png"))[2, 2, 0]
    lens = render.OrbitCamera.field_of_view
    assert_allclose(seen, _painted(light_map.background(), lens)[2, 2], atol=2)
    result = risorius("capture", *options, "-o", tmp_path / "seen.png")
    assert result.exit_code == 2
    assert "no map lights the scene; add --style light=FILE, or light=" in result.output
