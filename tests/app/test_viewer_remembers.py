"""A window has the settings of the last one, except where options set others."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from risorius.app.compiling_note import COMPILING_TEXT
from risorius.app.viewer.settings import Display, load_settings

from .driving import NEEDS_A_SCREEN
from .light_files import write_map

pytestmark = NEEDS_A_SCREEN


@pytest.mark.slow
def test_the_window_remembers(tmp_path):
    """`risorius replay --once` plays and ends; size and looks are restored.

    A broken settings file is ignored.
    """
    script = tmp_path / "short.toml"
    script.write_text("[[pose]]\ntime = 0.0\n[[pose]]\ntime = 0.6\njoy = 1.0\n")
    environment = {**os.environ, "XDG_CONFIG_HOME": str(tmp_path)}
    remembered = tmp_path / "risorius" / "viewer.json"
    remembered.parent.mkdir()
    remembered.write_text('{"size": ')
    root = Path(__file__).parents[2]
    command = [sys.executable, "-m", "risorius", "replay", str(script), "--once"]

    def replayed(*options):
        """The stored settings after a replay with these options."""
        result = subprocess.run(
            [*command, *options], capture_output=True, text=True, timeout=60, check=False,
            env=environment, cwd=root,
        )  # fmt: skip
        assert result.returncode == 0, result.stderr
        assert set(result.stderr.splitlines()) <= {COMPILING_TEXT}
        settings, complaint = load_settings(remembered)
        assert complaint == ""
        return settings

    start = time.monotonic()
    settings = replayed("--size", "500x400", "--style", "wireframe", "--look", "paper")
    assert time.monotonic() - start > 0.6
    assert settings.size == (500, 400)
    assert settings.recent == [str(script)]
    assert settings.display == Display(look="paper", wireframe=True)
    assert replayed().display == settings.display
    assert replayed("--look", "smooth").display == Display()  # chosen, though the default
    sky = write_map(tmp_path / "sky.hdr")
    relative = os.path.relpath(sky, root)
    settings = replayed("--style", f"light={relative}")
    assert settings.display == Display(light=str(root / relative))  # for windows in other folders
    assert settings.recent == [str(script), str(root / relative)]
    assert replayed().display == settings.display
