"""Locks of hair: they break outlines, soften hairlines, and belong to sound parts."""

import numpy as np
import pytest
from scipy.ndimage import label
from scipy.spatial import cKDTree

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.drawing import camera_for
from risorius.app.passes.passes import Passes
from risorius.app.scenes import FaceScene
from risorius.assets import Segment, load
from risorius.assets.identities import built_in_hair, person_called
from risorius.assets.identities.locks import SHORT_HAIR, TIED_HAIR, VERTEX_COUNT, locks_on
from risorius.assets.identities.single_hairs import LOCK_COUNT
from risorius.geometry.closest import closest_points
from risorius.geometry.normals import cross_products
from risorius.render import Style
from tests.assets.checks import part_of


def head_called(name):
    """The built-in head, or a person by number or name."""
    return load("head") if name == "head" else person_called(name)


def picture(name, view, size=(700, 700)):
    """A picture on nothing, RGBA."""
    with Capture(
        FaceScene(head_called(name)), CaptureOptions(size, style=Style(background=None))
    ) as c:
        c.camera = camera_for(c.scene, view)
        return c.draw_image().astype(np.float64)


@pytest.mark.parametrize("growth", [SHORT_HAIR, TIED_HAIR])
def test_locks_are_sound_ribbons(growth):
    """The two corners of a station are equally far from its middle; a ribbon ends in a thin tip."""
    hair = built_in_hair(load("head"))[1]
    locks = locks_on(hair, growth)
    assert len(locks.vertices) == VERTEX_COUNT * growth.count
    for each in (locks.vertices, locks.normals, locks.colours, locks.striation):
        assert each.dtype == np.float32
        assert np.isfinite(each).all()
    assert 0.0 <= locks.colours.min() <= locks.colours.max() <= 1.0
    along = locks.striation[:, :3]
    half = locks.striation[:, 3:4]
    middles = locks.vertices - half * np.cross(locks.normals, along)
    rows = middles.reshape(growth.count, VERTEX_COUNT, 3)
    assert rows[:, ::2] == pytest.approx(rows[:, 1::2], abs=1e-4)
    lengths = np.linalg.norm(np.diff(rows[:, ::2], axis=1), axis=2).sum(axis=1)
    assert lengths.max() < 1.5 * growth.longest
    tips = half.reshape(-1, VERTEX_COUNT)[:, -2:]
    assert (tips[:, 0] > 0.0).all()  # else a tip has no two sides, and is a row of dots
    assert np.abs(tips).max() < 0.005  # [mm]
    assert (tips[:, 0] == -tips[:, 1]).all()
    outward = (cross_products(locks.vertices, locks.faces) * locks.normals[locks.faces[:, 0]]).sum(
        axis=1
    )
    assert (outward >= -1e-4).mean() > 0.98
    again = locks_on(hair, growth)
    assert (again.vertices == locks.vertices).all()


@pytest.mark.parametrize("name", ["head", 19, "kofi"])
def test_the_outline_of_short_hair_is_broken_by_ends(name):
    """Ends of hair stand off the outline above the head; it was a smooth arc.

    The test counts pixels that hair covers in part, in each column; layers alone have one.
    """
    alpha = picture(name, "0,0")[:250, 260:440, 3]
    is_part = (alpha > 8.0) & (alpha < 247.0)
    assert is_part.sum(axis=0).mean() > 1.6


def pixels_of(camera, places, size):
    """Pixels of points (n, 3) in a square picture: columns and rows, (n, 2)."""
    right, up, back = np.stack(camera.axes())
    off = places - camera.target
    scale = 0.5 * size / np.tan(np.radians(0.5 * camera.field_of_view))
    scale = scale / (camera.distance - off @ back)
    return (0.5 * size + np.stack([scale * (off @ right), -scale * (off @ up)], axis=1)).astype(int)


@pytest.mark.parametrize("name", [7, 19])
def test_a_whorl_is_no_flat_disc(name):
    """At the whorl strands differ from each other; they had one tone there."""
    hair = part_of(head_called(name), "hair")
    camera = camera_for(FaceScene(head_called(name)), "180,55")
    place = hair.vertices[np.argmin(hair.striation[:, 1])]
    column, row = pixels_of(camera, place[None], 500)[0]
    light = picture(name, "180,55", (500, 500))[..., :3].mean(axis=2)
    light = light[row - 15 : row + 16, column - 15 : column + 16]
    detail = light[3:-3] - 0.5 * (light[6:] + light[:-6])
    assert np.std(detail) > 1.5


@pytest.mark.parametrize("name", ["head", 40, 19])
def test_locks_of_the_nape_lie_side_by_side(name):
    """Locks of the nape agree with their neighbours; they crossed like thorns, as at the whorl.

    The agreement is the length of the mean of nine neighbouring unit directions.
    """
    parts = built_in_hair(load("head")) if name == "head" else head_called(name).parts
    locks = next(part for part in parts if part.name == "hair_locks")
    roots = locks.vertices[::VERTEX_COUNT]
    directions = locks.striation[::VERTEX_COUNT, :3]
    neighbours = cKDTree(roots).query(roots, k=9)[1]
    agreement = np.linalg.norm(directions[neighbours].mean(axis=1), axis=1)
    is_low = roots[:, 1] < np.percentile(roots[:, 1], 25.0)
    is_behind = roots[:, 2] < np.median(roots[:, 2])
    assert np.percentile(agreement[is_low & is_behind], 5.0) > 0.93


@pytest.mark.parametrize("number", [92000104, 92000113])
def test_tied_hair_lies_smooth(number):
    """Nine of ten locks end within 3 mm of the layers; they stood off by 6 mm, like a comb."""
    parts = {part.name: part for part in head_called(number).parts}
    layers = parts["hair"]
    tips = parts["hair_locks"].vertices[VERTEX_COUNT - 1 :: VERTEX_COUNT].astype(np.float64)
    outline = layers.vertices.astype(np.float64)
    nearest = closest_points(tips, outline, layers.faces)
    off = tips - nearest.interpolate(outline)
    height = (off * nearest.interpolate(layers.normals.astype(np.float64))).sum(axis=1)
    assert np.percentile(height, 90.0) < 3.0


def clear_dots(number, view):
    """The number of pixels of background within a picture of 1000 x 1000 pixels."""
    is_clear = picture(number, view, (1000, 1000))[..., 3] < 200.0
    regions, _ = label(is_clear, np.ones((3, 3)))
    outer = np.concatenate([regions[0], regions[-1], regions[:, 0], regions[:, -1]])
    return (~np.isin(regions, outer)).sum()


@pytest.mark.parametrize("view", ["20,-20", "30,-15"])
def test_no_light_shines_below_the_hem_of_tied_hair(view):
    """From below, no dots of background show between skin and hair of person 91000190.

    Once the view 20,-20 had 150 of them, and 30,-15 had 42.
    """
    assert clear_dots(91000190, view) < 5


@pytest.mark.parametrize(
    ("number", "view", "most"), [(8, "-60,10", 40), (11, "60,20", 10), (92000104, "15,0", 10)]
)
def test_no_light_shines_between_tied_hair_and_nape_or_ears(number, view, most):
    """No row of dots lies between tied hair and skin; there were 106, 41 and 42 of them."""
    assert clear_dots(number, view) < most


@pytest.mark.parametrize(("name", "least"), [(3, 300), (8, 300), (11, 60), (66, 60)])
def test_tied_hair_is_seen_from_the_front(name, least):
    """A tail or a knot is seen beside or above the head.

    The test counts its pixels; pictures once showed only a cap of hair.
    """
    scene = FaceScene(head_called(name))
    with Capture(scene, CaptureOptions((300, 300), passes=("segmentation",))) as capture:
        capture.draw_image()
        passes = Passes(capture.pipeline, capture.viewports[-1].drawn)
        labels = passes.draw(capture.camera, capture.options.style, ("segmentation",))
        is_hair = labels["segmentation"] == Segment.HAIR
        tied = part_of(scene.head, "hair_tied")
        seen = pixels_of(capture.camera, tied.vertices, 300)
    box = np.zeros_like(is_hair)
    left, top = seen.min(axis=0)
    right, bottom = seen.max(axis=0)
    box[max(top, 0) : bottom + 1, max(left, 0) : right + 1] = True
    assert (is_hair & box).sum() > least


@pytest.mark.parametrize("number", [12, 28])
def test_bobs_end_in_tips_and_not_in_teeth(number):
    """The hem of a bob is smooth from strand to strand, and locks end along it.

    Ends of neighbouring strands were up to 8 mm off their mean, and hems were a blur.
    """
    parts = {part.name: part for part in person_called(number).parts}
    strand_count = 51
    ends = parts["hair"].vertices.reshape(strand_count, -1, 3)[:, -1]
    assert np.abs(np.diff(ends[10:-10, 1], 2)).max() < 2.5
    for name in ("hair_tips_locks", "hair_inside_tips_locks"):
        tips = parts[name].vertices[VERTEX_COUNT - 1 :: VERTEX_COUNT]
        nearest = cKDTree(ends).query(tips)[1]
        off = tips[:, 1] - ends[nearest, 1]
        assert off.min() > -8.0
        assert (off < 0.0).mean() > 0.4
        assert off.max() < 12.0


@pytest.mark.parametrize("name", ["head", 40])
def test_hairs_of_the_outline_are_fine(name):
    """Except at the whorl, locks of short hair are 0.1 mm wide; they were 0.2 mm, like thorns."""
    parts = built_in_hair(load("head")) if name == "head" else head_called(name).parts
    part_called = {part.name: part for part in parts}
    hair = part_called["hair"]
    locks = part_called["hair_locks"]
    whorl = hair.vertices[np.argmin(hair.striation[:, 1])]
    roots = locks.vertices[::VERTEX_COUNT]
    is_away = np.linalg.norm(roots - whorl, axis=1) > 60.0
    half = np.abs(locks.striation[::VERTEX_COUNT, 3])[is_away]
    assert half.max() < 0.055


@pytest.mark.parametrize("number", [12, 28])
def test_single_hairs_cross_the_edges_of_bobs(number):
    """Thin locks follow the strands, end at many heights, and some lie in front of the layers.

    Edges of bobs were knife-edges: all strands ended within 3 mm, and none left the layers' edge.
    """
    parts = {part.name: part for part in person_called(number).parts}
    layers = parts["hair"].vertices.reshape(51, -1, 3)
    locks = parts["hair_locks"]
    assert np.isfinite(locks.vertices).all()
    ribbons = locks.vertices.reshape(LOCK_COUNT, -1, 3)
    lengths = np.linalg.norm(np.diff(ribbons[:, ::2], axis=1), axis=2).sum(axis=1)
    assert 20.0 < lengths.min() < lengths.max() < 60.0
    tips = ribbons[:, -1]
    hem = layers[:, -1]
    off = tips[:, 1] - hem[cKDTree(hem).query(tips)[1], 1]
    is_hem = off < 12.0
    assert is_hem.mean() > 0.2
    assert off[is_hem].std() > 3.0
    edge = layers[[0, -1]].reshape(-1, 3)
    ahead = ribbons - edge[cKDTree(edge).query(ribbons)[1]]
    assert (ahead[..., 2] > 1.0).any(axis=1).sum() > 10
