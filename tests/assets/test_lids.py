"""Folds of lids, and the neck, are drawn into the maps where the identity requires."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from risorius.assets.identities import Person, Sex, coloured, make_person, sample_identity
from risorius.assets.identities.larynx import larynx_of
from risorius.assets.identities.lids import fold_of
from risorius.assets.identities.sternomastoid import height_of, sternomastoids_of
from risorius.assets.loading import load
from tests.heads import person_of


@pytest.fixture(scope="module")
def person() -> Person:
    """A person."""
    return make_person(sample_identity(6, is_even=True))


def folded(person: Person, **own: float) -> Person:
    """The same person with changed lids."""
    return replace(person, identity=replace(person.identity, **own))


def test_creases_lie_as_high_as_the_identity_says(person):
    """A crease set 1 mm higher lies 1 mm higher along the skin; a hidden one has no shade."""
    middle = load("head").anatomy["palpebrale_superius_left"]
    heights = []
    for seen in (1.2, 2.2):
        lids = fold_of(folded(person, seen_lid=seen, hooding=0.0), "left", 1280)
        column = round(person.uv[middle, 0] * 1280) - lids.columns.start
        darkest = lids.light[:, column].argmin()
        heights.append(-darkest)
    rows = load("head").rings
    ends = [rows["eye_2_left"][5], rows["eye_4_left"][5]]
    length = np.linalg.norm(np.diff(person.vertices[ends], axis=0))
    texel_count = 1280 * float(np.diff(person.uv[ends, 1])[0])
    assert (heights[1] - heights[0]) * length / texel_count == pytest.approx(1.0, abs=0.35)
    hidden = fold_of(folded(person, seen_lid=-1.0), "right", 1280)
    assert (hidden.light == 1.0).all()
    assert hidden.heights.max() > 0.3


@pytest.mark.parametrize("side", ["left", "right"])
def test_creases_have_no_kinks(side):
    """Person 43's crease follows a smooth curve, although the lid's edge has only eleven points."""
    lids = fold_of(person_of(43), side, 1280)
    beyond = 0.22  # share of light that is missing below the crease, too
    dark = np.maximum(1.0 - lids.light - beyond, 0.0)
    dark = dark[:, dark.max(axis=0) > 0.05]
    row = (dark * np.arange(len(dark))[:, None]).sum(axis=0) / dark.sum(axis=0)
    end = len(row) // 8
    assert len(row) > 60
    assert np.abs(np.diff(row[end:-end], 2)).max() < 0.7  # texels


def test_hooding_lowers_the_outer_half_alone(person):
    """Hooding hides the crease in the outer half of the lid, and changes nothing at the nose."""
    plain, hooded = (
        fold_of(folded(person, seen_lid=1.5, hooding=h), "left", 1280).light for h in (0.0, 3.0)
    )
    half = plain.shape[1] // 3
    inner = slice(None, half)
    outer = slice(-half, None)
    assert (plain[:, inner] == hooded[:, inner]).mean() > 0.95
    assert plain[:, outer].min() < 0.6
    assert hooded[:, outer].min() > plain[:, outer].min() + 0.1


def test_folds_are_wrinkles_of_the_lids_alone(person):
    """Folds of lids show at rest where the skin can yield; smaller maps have the same shade."""
    open_eyed = folded(person, seen_lid=2.0)
    drawn, small = (coloured(open_eyed, angle=50.0, shrink=each).wrinkles for each in (1, 4))
    hidden = coloured(folded(person, seen_lid=-3.0), angle=50.0)
    head = load("head")
    assert_array_equal(hidden.ambient_occlusion, head.ambient_occlusion)
    depth, plain = (each.map[..., 2].astype(float) for each in (drawn, hidden.wrinkles))
    rows, columns = np.nonzero(depth != plain)
    size = len(depth)
    places = np.column_stack([(columns + 0.5) / size, 1.0 - (rows + 0.5) / size])
    lids = [head.uv[head.rings[f"eye_2_{side}"][1:10]] for side in ("left", "right")]
    away = np.linalg.norm(places[:, None] - np.concatenate(lids), axis=2).min(axis=1)
    assert len(rows) > 1500
    assert away.max() < 0.04
    for side in ("left", "right"):
        creased = head.rings[f"eye_3_{side}"][3:8]
        assert (drawn.resting[creased] == 1.0).all()
        assert (np.linalg.norm(drawn.across[creased], axis=2) > 0.99).all()
    means = (depth - plain).reshape(320, 4, 320, 4).mean(axis=(1, 3))
    shade = small.map[..., 2] - plain.reshape(320, 4, 320, 4).mean(axis=(1, 3))
    seen = means > 20.0
    assert shade[seen].mean() == pytest.approx(means[seen].mean(), rel=0.2)


def test_people_show_as_much_of_their_lids_as_measured():
    """The visible parts of the lids of 200 persons at fifty are 1.4 ± 1.1 mm high, as measured."""
    seen = [sample_identity(seed, age=50.0).seen_lid for seed in range(200)]
    assert 1.2 < np.mean(seen) < 1.7
    assert 0.9 < np.std(seen) < 1.4


def test_the_larynx_stands_out_as_far_as_the_identity_says(person):
    """The larynx is a ridge in the middle of the neck, as high as the identity requires.

    It is higher in men, and fades out within its map.
    """
    found = larynx_of(folded(person, larynx=4.0), 1024)
    column = found.heights.max(axis=0).argmax()
    assert column + found.columns.start == pytest.approx(511.5, abs=12.0)
    assert found.heights.max() == pytest.approx(4.0, abs=0.6)
    assert np.abs(found.heights[:, [0, -1]]).max() < 0.01
    assert np.abs(found.heights[[0, -1]]).max() < 0.4
    for sex, least, most in ((Sex.MAN, 1.5, 5.0), (Sex.WOMAN, 0.0, 0.8)):
        drawn = [sample_identity(seed, sex=sex).larynx for seed in range(20)]
        assert least <= min(drawn) < max(drawn) <= most


def test_sternomastoids_stand_out_of_lean_and_old_necks(person):
    """Sternomastoids are ridges on both sides of the neck, as high as the identity requires.

    They are higher in the old and the lean.
    """
    even = folded(person, sternomastoid=0.0)
    lean = height_of(even)
    raised, sunk = (
        sternomastoids_of(folded(person, sternomastoid=own - lean), 1024) for own in (1.5, -0.5)
    )
    for found, mirrored in (raised, raised[::-1]):
        assert 1.4 < found.heights.max() < 2.1
        assert np.abs(found.heights[0]).max() < 0.05
        np.testing.assert_allclose(found.heights.max(), mirrored.heights.max(), atol=0.02)
        assert found.columns.start + mirrored.columns.stop == pytest.approx(1024, abs=2)
    assert min(found.heights.min() for found in sunk) == pytest.approx(-0.5, abs=0.05)
    assert max(found.heights.max() for found in sunk) < 0.01
    young, old = (
        np.mean([sample_identity(seed, age=age).sternomastoid for seed in range(60)])
        for age in (25.0, 70.0)
    )
    assert old > young + 0.6
    cheeks = [person.anatomy[f"zygion_{side}"] for side in ("left", "right")]
    vertices = person.vertices.copy()
    vertices[cheeks] *= [1.04, 1.0, 1.0]
    assert height_of(replace(even, vertices=vertices)) > lean + 0.1
