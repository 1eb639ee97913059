"""Without extras: pictures are drawn, and what is missing is named with what installs it."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXTRAS = {
    "window": ("glfw", "imgui_bundle", "miniaudio"),
    "films": ("imageio_ffmpeg",),
    "live": ("pythonosc",),
    "export": ("h5py", "pxr"),
    "passes": ("OpenEXR",),
    "cluster": ("distributed",),
}
WITHOUT = f"""
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {sum(EXTRAS.values(), ())!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Missing())
from risorius.__main__ import run
run()
"""


def plain(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """The command as `pip install risorius` alone has it."""
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    return subprocess.run(
        [sys.executable, "-c", WITHOUT, *words],
        cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


def test_a_picture_needs_no_extra(tmp_path: Path) -> None:
    """Nor does a folder of frames, nor help, nor a glTF file."""
    small = ("--size", "64x48", "--quiet")
    for words in (
        ("capture", "--set", "joy", "-o", "joy.png", *small),
        ("export", "--set", "joy", "-o", "joy.glb", "--quiet"),
        ("--help",),
    ):
        ended = plain(*words, folder=tmp_path)
        assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "joy.png").exists() and (tmp_path / "joy.glb").exists()


@pytest.mark.parametrize(
    ("extra", "command"),
    [
        ("window", "view"),
        ("films", "capture --set joy -o joy.mp4 --size 64x48 --quiet"),
        ("live", "send take.csv --to vmc"),
        ("export", "export --set joy -o joy.usd --quiet"),
        ("passes", "capture --set joy -o joy.png --passes depth --size 64x48 --quiet"),
        ("cluster", "batch list.txt --scheduler tcp://127.0.0.1:9 --quiet"),
    ],
)
def test_what_is_missing_is_named(extra: str, command: str, tmp_path: Path) -> None:
    """In one line, with the command that installs it; nothing is left behind."""
    (tmp_path / "take.csv").write_text("time,jawOpen\n0,0\n0.1,0.5\n0.2,0\n")
    (tmp_path / "list.txt").write_text("export --set joy -o joy.npz\n")
    before = {"take.csv", "list.txt"}
    ended = plain(*command.split(), folder=tmp_path)
    assert ended.returncode == 2 and ended.stderr.count("\n") == 1, ended.stderr
    assert ended.stderr.endswith(f"; install it: pip install 'risorius[{extra}]'\n")
    assert {path.name for path in tmp_path.iterdir()} - {"list_logs"} == before


def test_extras_bring_what_they_are_named_for() -> None:
    """And `all` brings every extra that a user of the program may want."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    packages = {"pxr": "usd-core", "imgui_bundle": "imgui-bundle", "pythonosc": "python-osc"}
    for extra, modules in EXTRAS.items():
        for module in modules:
            package = packages.get(module, module.replace("_", "-"))
            assert any(each.startswith(package) for each in extras[extra]), module
            assert not any(each.startswith(package) for each in project["dependencies"]), module
    (everything,) = extras["all"]
    assert all(extra in everything for extra in EXTRAS)
