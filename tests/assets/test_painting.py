"""The picture of the skin: where it is red, dark and hairy, in every tone, and how it is read."""

import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from risorius import assets
from risorius.assets.generator import brows, form
from risorius.assets.generator.noise import noise
from risorius.assets.generator.painting import paint_skin
from risorius.assets.generator.pigments import COMPLEXIONS, reflectance
from risorius.assets.generator.texels import Texels, corner_values, left_texels, rasterise
from risorius.assets.loading import HEAD_FILE, load_head
from risorius.assets.model import Head
from risorius.geometry.colour import to_linear, to_screen

Colours = npt.NDArray[np.float64]
LARGEST_IMAGE_FILE = 1_250_000  # bytes


@pytest.fixture(scope="module")
def head() -> Head:
    """The built-in head."""
    return assets.load("head")


@pytest.fixture(scope="module")
def texels(head: Head) -> Texels:
    """The texels of the shipped image."""
    return left_texels(head, len(head.albedo))


def colours_at(head: Head, texels: Texels, points: list[tuple[float, float]]) -> Colours:
    """Mean colour around points of the left half in front view [mm], 0..1, shape (3,)."""
    away = np.linalg.norm(texels.points[:, None, :2] - np.array(points), axis=2).min(axis=1)
    near = (away < 2.0) & (texels.points[:, 2] > 60.0) & (texels.mouth_row > 2.0)
    return np.asarray(head.albedo[texels.rows[near], texels.columns[near]].mean(axis=0) / 255.0)


def redness(colour: Colours) -> float:
    """How far red stands out from green and blue, whatever the lightness."""
    return float(colour[0] / colour[1:].mean())


def test_albedo_is_a_picture(head: Head) -> None:
    """Square, 8 bits, three channels, read-only, light on disk, and read only once."""
    assert head.albedo.dtype == np.uint8 and head.albedo.ndim == 3
    assert head.albedo.shape[0] == head.albedo.shape[1] >= 1024 and head.albedo.shape[2] == 3
    assert head.albedo is head.albedo
    assert head.albedo_file.stat().st_size < LARGEST_IMAGE_FILE
    with pytest.raises(ValueError, match="read-only"):
        head.albedo[0] = 0


def test_lips_are_redder_than_the_cheek(head: Head, texels: Texels) -> None:
    """Both lips, and darker; but skin all the same, not paint."""
    cheek = colours_at(head, texels, [(40.0, -40.0)])
    for point in ((8.0, -62.0), (8.0, -72.0)):
        lip = colours_at(head, texels, [point])
        assert redness(lip) > 1.1 * redness(cheek)
        assert 0.6 * cheek.mean() < lip.mean() < 0.95 * cheek.mean()


def test_brow_is_darker_than_the_forehead(head: Head, texels: Texels) -> None:
    """At every brow landmark but the outermost, where hairs are few."""
    forehead = colours_at(head, texels, [(20.0, 45.0), (0.0, 45.0)])
    for number in (23, 24, 25):
        x, y, _ = head.vertices[head.landmarks[number]]
        assert (
            colours_at(head, texels, [(float(x), float(y) - 1.5)]).mean() < 0.75 * forehead.mean()
        )


def test_scalp_is_darker_than_the_forehead_and_the_nose_redder(head: Head, texels: Texels) -> None:
    """A shaved head, and blood where it is near the surface."""
    forehead = colours_at(head, texels, [(0.0, 50.0)])
    assert colours_at(head, texels, [(0.0, 92.0)]).mean() < 0.85 * forehead.mean()
    assert redness(colours_at(head, texels, [(0.0, -33.0)])) > redness(forehead)
    assert redness(colours_at(head, texels, [(44.0, -24.0)])) > redness(forehead)


def test_inside_of_mouth_and_nostril_is_dark(head: Head, texels: Texels) -> None:
    """What opens when the mouth does is wet and red, deeper in almost black."""
    painted = head.albedo[texels.rows, texels.columns] / 255.0
    inside = painted[texels.mouth_row < 0.5].mean(axis=0)
    assert inside.mean() < 0.35 and redness(inside) > 1.6
    assert painted[texels.nostril > 0.6].mean() < 0.3


def test_picture_is_mirrored_but_for_patches_and_grain(head: Head) -> None:
    """Patches, pores and freckles differ from side to side; red and dark places do not."""
    image = head.albedo.astype(np.int64)
    difference = np.abs(image - image[:, ::-1])
    assert 0.5 < difference.mean() < 6.0
    size = len(image) // 40
    blocks = image[: 40 * size, : 40 * size].reshape(40, size, 40, size, 3).mean(axis=(1, 3))
    off = np.abs(blocks - blocks[:, ::-1])
    assert off.mean() < 3.0 and off.max() < 25.0


def test_picture_goes_on_outside_the_skin(head: Head) -> None:
    """A filter that reaches over the rim finds skin, not a border."""
    rim = head.rings["rim_left"][3:-3]
    size = len(head.albedo)
    inside = head.uv[rim] * [size, -size] + [0.0, size]
    outward = inside - size / 2
    beyond = inside + 4.0 * outward / np.linalg.norm(outward, axis=1, keepdims=True)
    near, far = (
        head.albedo[place[:, 1].astype(int), place[:, 0].astype(int)].astype(int)
        for place in (inside, beyond)
    )
    assert np.abs(near - far).mean() < 12.0


@pytest.mark.slow
def test_tones_are_ordered_and_all_have_lips() -> None:
    """From light to dark, each clearly darker than the one before."""
    sizes = 256
    head = assets.load("head")
    images = [paint_skin(head, complexion=each, size=sizes) for each in COMPLEXIONS]
    lightness = [float(image.mean()) for image in images]
    assert all(first > second + 8.0 for first, second in pairwise(lightness))


def test_missing_or_broken_picture_is_told_when_it_is_asked_for(tmp_path: Path) -> None:
    """A head without its picture can still be simulated."""
    shutil.copy(HEAD_FILE, tmp_path / "head.npz")
    head = load_head(tmp_path / "head.npz")
    with pytest.raises(
        assets.AssetError, match=r"missing; paint it with 'python -m risorius.assets.build'"
    ):
        _ = head.albedo
    head.albedo_file.write_bytes(b"no picture")
    with pytest.raises(assets.AssetError, match="not a readable picture"):
        _ = head.albedo
    head.albedo_file.write_bytes(HEAD_FILE.with_suffix(".png").read_bytes()[:9000])
    with pytest.raises(assets.AssetError, match="not a readable picture"):
        _ = head.albedo


def test_loading_reads_no_picture() -> None:
    """Who only simulates waits for no PNG."""
    code = (
        "import sys; from risorius import assets; assets.load('head');"
        "assert 'PIL' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_texels_know_where_they_are(head: Head) -> None:
    """Texels at vertices have the vertices' places; rows lie between their rings."""
    texels = left_texels(head, 512)
    place = np.column_stack([texels.columns + 0.5, 512 - texels.rows - 0.5]) / 512
    tip = head.anatomy["pronasale"]
    nearest = np.argmin(np.linalg.norm(place - head.uv[tip], axis=1))
    assert np.linalg.norm(texels.points[nearest] - head.vertices[tip]) < 1.0
    assert texels.points[:, 0].min() >= 0.0
    on_red = (texels.mouth_row > 3.0) & (texels.mouth_row < 6.0)
    assert np.all(np.abs(texels.points[on_red, 1] + 67.0) < 13.0)
    values = corner_values(head)
    assert values[head.anatomy["nostril_roof_left"], 4] == 1.0
    assert np.all(values[head.rings["nostril_left"], 4] == 0.0)


def test_each_texel_belongs_to_one_face() -> None:
    """Two triangles of a square cover every texel of it once, with weights that sum to one."""
    flat = np.array([[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]])
    texel, owner, share = rasterise(flat, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), 8)
    assert np.array_equal(texel, np.arange(64))
    assert np.bincount(owner).min() >= 28
    assert np.allclose(share.sum(axis=1), 1.0)


def test_hairs_grow_on_the_brow() -> None:
    """On the surface, upward at the inner end, outward and down at the tail, thin everywhere."""
    hairs = brows.hairs()
    lines = np.array([hair.line for hair in hairs])
    assert np.abs(form.distance(lines.reshape(-1, 3))).max() < 0.1
    growth = lines[:, -1] - lines[:, 0]
    inner, tail = lines[:, 0, 0] < 14.0, lines[:, 0, 0] > 46.0
    assert growth[inner, 1].mean() > 1.5
    assert growth[tail, 0].mean() > 1.0 and growth[tail, 1].mean() < -0.5
    assert max(hair.width for hair in hairs) < 0.3
    assert lines[..., 1].max() < 30.0 and lines[..., 1].min() > 6.0


def test_noise_is_the_same_for_ever_and_balanced() -> None:
    """Known values guard the shipped picture against a changed hash; smooth noise has no steps."""
    points = np.random.default_rng(2).uniform(-90.0, 90.0, size=(4000, 3))
    smooth = noise(points, 5.0, seed=1)
    assert abs(smooth.mean()) < 0.05
    assert 0.3 < smooth.std() < 0.8
    assert np.array_equal(smooth, noise(points, 5.0, seed=1))
    assert not np.allclose(smooth, noise(points, 5.0, seed=2))
    assert np.abs(noise(points + 0.001, 5.0, seed=1) - smooth).max() < 0.01


def test_pigments_absorb() -> None:
    """Melanin darkens all colours and blue most; blood takes green and blue, and leaves red."""
    none, some = np.zeros(1), np.ones(1)
    bare = reflectance(none, none, none)[0]
    brown, flushed = reflectance(some, none, none)[0], reflectance(none, some, none)[0]
    assert np.all(brown < bare) and brown[2] / bare[2] < brown[0] / bare[0]
    assert flushed[0] > 0.9 * bare[0] and flushed[1] < 0.7 * bare[1]
    assert np.allclose(to_screen(to_linear(bare)), bare)
