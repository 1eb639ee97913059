"""Numbers on pages equal the results of today's commands, within the page's tolerance."""

import re
import textwrap
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.bench.reproduce import table1

from .app.command_line import succeeded
from .app.glb_player import Player

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def numbers_of(page, pattern):
    """The numbers of a pattern that occurs once on a page.

    A blank in it also matches a line end.
    """
    text = " ".join(page.read_text("utf-8").split())
    found = re.findall(pattern, text)
    assert len(found) == 1, f"{page.name} has {len(found)} places like {pattern!r}"
    groups = [found[0]] if isinstance(found[0], str) else found[0]
    return [float(group) for group in groups]


def test_triangles_of_table_1():
    """Two pages have the same largest triangle counts of face and plane as `reproduce table1`."""
    values = table1.outcome(rounds=1).values
    ours = [values["face, most triangles"], values["plane, most triangles"]]
    on_index = numbers_of(
        DOCS / "index.md", r"here they are (\d+) and (\d+) \(`risorius reproduce table1`"
    )
    assert on_index == approx(ours, rel=0.01)
    on_refinement = numbers_of(DOCS / "refinement.md", r"today the face has (\d+) triangles")
    assert on_refinement == approx(ours[:1], rel=0.01)


@pytest.mark.parametrize("script", ["face", "speech"])
def test_table_of_exported_files(script, tmp_path):
    """The page on export has the frames, targets and file sizes of the built-in scripts."""
    row = rf"\| `{script}\.toml`, built in \| (\d+) \| (\d+) \| ([\d.]+) MB \| ([\d.]+) mm"
    frames, residual, size, _ = numbers_of(DOCS / "export.md", row)
    path = tmp_path / "exported.glb"
    succeeded("export", str(ROOT / f"assets/scripts/{script}.toml"), "-o", str(path), "--quiet")
    player = Player(path)
    assert len(player.times) == frames
    named = len(ARKIT_SHAPES)
    assert len(player.primitive("skin").targets) == approx(named + residual, abs=2)
    assert path.stat().st_size / 1e6 == approx(size, rel=0.1)


@pytest.mark.parametrize(("row", "options"), [("simulated", []), ("`--refined`", ["--refined"])])
def test_table_of_refined_skins(row, options, tmp_path):
    """The page on export has the sizes of files of the skin as it is simulated, and as it is drawn.

    They grew unnoticed when the head got hair.
    """
    found = numbers_of(
        DOCS / "export.md", rf"\| {row} \| \d+ \| ([\d.]+) MB \| [\d.]+ MB \| ([\d.]+) MB"
    )
    for size, name in zip(found, ("clip.glb", "clip.usdz"), strict=True):
        path = tmp_path / name
        succeeded("export", str(DOCS / "hello.toml"), *options, "-o", str(path), "--quiet")
        assert path.stat().st_size / 1e6 == approx(size, rel=0.1)


def test_size_of_a_sample(tmp_path):
    """The page on data sets has the mean size of a sample, with float passes and without."""
    plain, floats = numbers_of(
        DOCS / "dataset.md", r"A sample has ([\d.]+) kB; float passes add ([\d.]+) MB"
    )
    faces = tmp_path / "faces"
    command = ["dataset", "--count", "6", "--passes", "segmentation,depth,normal", "-o", str(faces)]
    succeeded(*command, "--size", "512x512", "--quiet")
    files = [path for path in faces.rglob("*") if path.stem[0].isdigit()]
    exr = sum(path.stat().st_size for path in files if path.suffix == ".exr")
    everything = sum(path.stat().st_size for path in files)
    assert (everything - exr) / 6e3 == approx(plain, rel=0.2)
    assert exr / 6e6 == approx(floats, rel=0.2)


def test_code_that_reads_a_set(tmp_path, monkeypatch):
    """The page's lines that read a data set run unchanged in a checkout."""
    page = (DOCS / "dataset.md").read_text("utf-8")
    code = re.search(r"(?:^    .*\n|^\n)*^    sample = faces.*$", page, re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(ROOT))
    succeeded("dataset", "--count", "4", "-o", "faces", "--size", "64x64", "--quiet")
    names = {}
    exec(compile(textwrap.dedent(code[0]), "page", "exec"), names)
    sample = names["sample"]
    assert isinstance(sample, dict)
    assert sample["image"].shape == (3, 64, 64)
    assert np.isfinite(sample["units"]).all()
