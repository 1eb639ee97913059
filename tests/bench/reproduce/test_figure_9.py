"""The paper's Fig. 9: what it claims of the refined plane holds against the true sine."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from risorius.bench.canvas import Canvas
from risorius.bench.reproduce import figure_9
from risorius.bench.reproduce.figure_9 import PHASES, SHADINGS, VARIANTS, Variant, Waving

STATIC, REFINED, OWN_NORMALS, CUBIC = VARIANTS
STYLES = dict(SHADINGS)


@pytest.fixture(scope="module")
def plane() -> Iterator[Waving]:
    """The plane in the figure's own size."""
    with Canvas((380, 230)) as canvas:
        yield Waving(canvas)


def _off(plane: Waving, variant: Variant, shading: str) -> tuple[float, float]:
    """Levels and share of the outline that a row is off, in the mean over its columns."""
    pairs = [
        (plane.image(variant, STYLES[shading], phase)[0], plane.true_image(phase))
        for phase in PHASES
    ]
    return (
        float(np.mean([figure_9.levels_apart(*pair) for pair in pairs])),
        float(np.mean([figure_9.outline_apart(*pair) for pair in pairs])),
    )


def test_layout() -> None:
    """A row for each variant in each shading and one for the truth; a column for each moment."""
    few = figure_9.draw((96, 64), variants=VARIANTS[:2])
    all_rows = figure_9.draw((96, 64), variants=(*VARIANTS[:2], Variant("more", "loop")))
    assert few.shape[1] == all_rows.shape[1] == 3 * 96
    assert few.shape[0] / 5 == all_rows.shape[0] / 7
    assert few.std() > 10.0


def test_nothing_is_off_from_itself(plane: Waving) -> None:
    """The measures are 0 for the truth, and see a shade and an outline that differ."""
    truth = plane.true_image(0.0)
    assert figure_9.levels_apart(truth, truth) == figure_9.outline_apart(truth, truth) == 0.0
    shows = truth.mean(axis=2) < 250
    lighter = np.where(shows[..., None], truth + 8, truth).astype(np.uint8)
    assert figure_9.levels_apart(lighter, truth) == pytest.approx(8.0, abs=0.5)
    moved = np.roll(truth, 3, axis=1)
    assert 0.01 < figure_9.outline_apart(moved, truth) < 0.1


def test_the_truth_is_dense_enough(plane: Waving) -> None:
    """All shadings of the true sine look alike: no triangle of it shows."""
    coarse = plane.image(STATIC, STYLES["flat"], 0.0)[0]
    vertices, faces = plane._dense
    positions, normals = plane._wave(0.0).waved(vertices)
    truth = plane.true_image(0.0)
    flat = plane._canvas.draw_surface(
        positions, normals, faces, figure_9.Drawing(plane._camera, STYLES["flat"])
    )
    assert figure_9.levels_apart(flat, truth) < 1.0 < figure_9.levels_apart(coarse, truth)


@pytest.mark.slow
def test_flat_ridges_are_smoothed_out(plane: Waving) -> None:
    """Flat shaded, refined triangles are nearer to the sine; most of the surface changes."""
    static, refined = (_off(plane, variant, "flat")[0] for variant in (STATIC, REFINED))
    assert refined < 0.85 * static
    pictures = [plane.image(variant, STYLES["flat"], 0.0)[0] for variant in (STATIC, REFINED)]
    changed = np.abs(np.diff(np.asarray(pictures, int), axis=0)).max(axis=(0, 3)) > 8
    assert changed.sum() > 0.3 * (plane.true_image(0.0).mean(axis=2) < 250).sum()


@pytest.mark.slow
def test_interpolated_normals_leave_gouraud_shading_as_it_is(plane: Waving) -> None:
    """The paper's rule moves points, not normals: its shading is no nearer to the sine's."""
    static, refined = (_off(plane, variant, "Gouraud")[0] for variant in (STATIC, REFINED))
    assert refined == pytest.approx(static, rel=0.1)


@pytest.mark.slow
def test_normals_of_the_refined_surface_mend_gouraud_shading(plane: Waving) -> None:
    """The same points with normals of their own are nearer to the sine; the outline is the same."""
    static, linear, own = (
        _off(plane, variant, "Gouraud") for variant in (STATIC, REFINED, OWN_NORMALS)
    )
    assert own[0] < 0.85 * static[0]
    assert own[1] == pytest.approx(linear[1], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("shading", STYLES)
def test_curves_are_nearer_in_shade_and_outline(plane: Waving, shading: str) -> None:
    """What interpolates the plane is nearer to the sine than the plane is, in both."""
    static, cubic = (_off(plane, variant, shading) for variant in (STATIC, CUBIC))
    assert cubic[0] < 0.8 * static[0]
    assert cubic[1] < 0.6 * static[1]


def test_no_corner_of_the_plane_is_a_speck(plane: Waving) -> None:
    """Nothing is as dark as an underside, which has no light."""
    for phase in PHASES:
        assert 90 < plane.image(STATIC, STYLES["flat"], phase)[0].min() < 200
