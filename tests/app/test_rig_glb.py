"""An avatar of a GLB file is a copy of that file with more shapes."""

import json
import struct

import numpy as np
import pytest

from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.rig.poses import rest_in
from risorius.app.scenes import FaceScene
from risorius.assets.coarse import coarse_head

from .command_line import refusal, risorius, succeeded
from .glb_player import Player, document

pytestmark = pytest.mark.usefixtures("shared_fits")

METRES_PER_MILLIMETRE = 0.001


@pytest.fixture(scope="module")
def coarse():
    """The coarse head, because a file of the built-in one takes three times as long."""
    return FaceScene(coarse_head())


@pytest.fixture(scope="module")
def copied(coarse, shared_fits, tmp_path_factory):
    """A GLB with bones, shapes, motion and extras, and its avatar."""
    folder = tmp_path_factory.mktemp("glb")
    own = folder / "own.glb"
    words = ("--head", "coarse", "--set", "joy=0.5", "--fps", 5, "--quiet")
    succeeded("export", *words, "-o", own)
    data = own.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    parts = json.loads(data[20 : 20 + length])
    parts["nodes"][0]["extras"] = {"owner": "somebody"}
    parts["extensionsUsed"] = ["EXT_somebody"]
    parts["extensions"] = {"EXT_somebody": {"kept": [1, 2, 3]}}
    text = json.dumps(parts).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + data[20 + length :]
    own.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
    points = METRES_PER_MILLIMETRE * coarse.rest_positions[coarse.landmarks]
    landmarks = folder / "own.json"
    landmarks.write_text(json.dumps({"landmarks": points.tolist()}))
    path = folder / "rigged.glb"
    succeeded("rig", own, "--landmarks", landmarks, "-o", path)
    return own, path


def test_a_glb_comes_back_as_it_was(copied):
    """Nodes, skins, materials, extras, extensions and data are kept; shapes are appended."""
    own, path = copied
    before = document(own)
    after = document(path)
    for key in ("nodes", "skins", "materials", "images", "extensions", "extensionsUsed", "scenes"):
        assert after[key] == before[key], key
    for key in ("accessors", "bufferViews"):
        assert after[key][: len(before[key])] == before[key], key
    data = Player(own).blob
    assert Player(path).blob[: len(data)] == data
    for old, new in zip(before["meshes"], after["meshes"], strict=True):
        primitive = old["primitives"][0]
        kept = {key: value for key, value in primitive.items() if key != "targets"}
        assert kept.items() <= new["primitives"][0].items()
        count = len(primitive.get("targets", ()))
        assert new["primitives"][0].get("targets", [])[:count] == primitive.get("targets", [])


def test_pieces_of_a_glb_cannot_be_hidden(copied, tmp_path):
    """A copied file keeps all its triangles, so the role `hidden` is refused in one line."""
    own, _ = copied
    words = ("--landmarks", own.with_suffix(".json"), "--piece", "1=hidden")
    line = refusal(risorius("rig", own, *words, "-o", tmp_path / "a.glb"))
    assert "copied as it is, so its pieces cannot be hidden" in line
    assert not list(tmp_path.iterdir())


def test_shapes_of_a_glb_are_those_of_the_simulation(copied, coarse):
    """Shapes equal the simulation's, also under bones and for vertices doubled at seams."""
    player = Player(copied[1])
    shapes = player.shapes("skin")
    # The file has shapes with the same names, so these names differ.
    assert tuple(shapes)[-52:] == tuple(f"{name}.risorius" for name in ARKIT_SHAPES)
    moved = rest_in(coarse, {"jawOpen": 1.0}).skin - coarse.rest_positions
    opened = shapes["jawOpen.risorius"]
    assert np.median(np.abs(opened / METRES_PER_MILLIMETRE - moved)) < 0.5
    assert opened[:, 1].min() < -0.02
    # Lower teeth are children of a mandible node, which stands still.
    assert player.shapes("teeth_lower")["jawOpen"][:, 1].max() < -0.005


def test_motion_of_a_glb_is_kept(copied):
    """The file's animation is unchanged, with weights of 0 for the added shapes."""
    own, path = copied
    before = Player(own)
    after = Player(path)
    for frame in (0, len(before.times) - 1):
        off = before.positions("skin", frame) - after.positions("skin", frame)
        assert np.abs(off).max() < 1e-6
