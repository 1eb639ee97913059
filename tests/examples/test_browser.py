"""The web page that plays an avatar in a browser."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from tests.app.command_line import succeeded

PAGE = Path(__file__).parents[2] / "examples" / "browser" / "avatar.html"


def test_the_page_fetches_nothing_from_other_servers():
    """The page has no address of another server: three.js, installed by the user, is beside it."""
    text = PAGE.read_text(encoding="utf-8")
    assert "npm install three" in text
    assert re.findall(r"(?:https?:)?//[\w.-]+\.\w+", text) == []
    imports = re.findall(r'"three[/\w]*": "([^"]+)"', text)
    assert len(imports) == 2
    assert all(name.startswith("./node_modules/three/") for name in imports)


@pytest.mark.slow
def test_a_browser_shows_the_shapes(tmp_path):
    """A headless Chromium draws an open jaw, shut lids and a smile, each at its place.

    RISORIUS_NODE_MODULES names the node_modules with three, puppeteer-core, @sparticuz/chromium.
    """
    modules = os.environ.get("RISORIUS_NODE_MODULES")
    if modules is None or shutil.which("node") is None:
        pytest.skip("no RISORIUS_NODE_MODULES with three and a browser, or no node")
    shutil.copy(PAGE, tmp_path)
    (tmp_path / "node_modules").symlink_to(Path(modules).resolve())
    succeeded("rig", "-o", tmp_path / "avatar.glb", "--quiet")
    shapes = ("rest", "jawOpen", "eyeBlink", "mouthSmile")
    program = Path(__file__).with_name("in_browser.mjs")
    command = ["node", str(program), str(tmp_path), *shapes]
    found = subprocess.run(command, check=True, capture_output=True, text=True)
    assert "52 shapes" in found.stdout
    rest, *others = (
        np.asarray(PIL.Image.open(tmp_path / f"{shape}.png").convert("L"), float)[:, 270:]
        for shape in shapes
    )
    heights = []
    for picture in others:
        change = np.abs(picture - rest) > 25.0
        assert change.sum() > 200
        heights.append(np.median(np.nonzero(change)[0]))
    jaw, lids, smile = heights
    assert lids < min(jaw, smile) - 20.0
