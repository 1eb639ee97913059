"""Babylon.js, an independent glTF reader, loads an avatar's shapes by name."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from risorius.app.recordings.names import ARKIT_SHAPES
from tests.app.command_line import succeeded
from tests.app.glb_player import Player


@pytest.mark.slow
def test_babylon_has_the_shapes_by_name(tmp_path):
    """Babylon.js finds ARKit's 52 shapes in Apple's order, and the eyes as nodes.

    Each shape at weight 1 moves the skin correctly. RISORIUS_NODE_MODULES names the node_modules
    with @babylonjs/core and @babylonjs/loaders.
    """
    modules = Path(os.environ.get("RISORIUS_NODE_MODULES", "none")).resolve()
    if not (modules / "@babylonjs" / "loaders").is_dir() or shutil.which("node") is None:
        pytest.skip("no RISORIUS_NODE_MODULES with @babylonjs/core and loaders, or no node")
    avatar = tmp_path / "avatar.glb"
    succeeded("rig", "-o", avatar, "--quiet")
    shapes = ("jawOpen", "eyeBlinkLeft", "mouthSmileRight", "tongueOut")
    program = Path(__file__).with_name("in_babylon.mjs")
    command = ["node", str(program), str(modules), str(avatar), "skin", *shapes]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert tuple(found["names"]) == ARKIT_SHAPES
    assert {"eye_left", "eye_right", "cranium"} <= set(found["nodes"])
    player = Player(avatar)
    rest = player.attribute("skin", "POSITION")
    own = {name: rest + change for name, change in player.shapes("skin").items()} | {"rest": rest}
    for name in ("rest", *shapes):
        places = np.reshape(found["places"][name], (-1, 3))
        assert np.abs(places - own[name]).max() < 1e-6, name
