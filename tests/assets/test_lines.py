"""Expression lines (wrinkles of habit): their numbers by age and sex, and their maps."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from risorius.assets.identities import Sex, coloured, sample_identity
from risorius.assets.identities.furrow_map import _line_regions, shared_map, with_lines
from risorius.assets.identities.furrows import SAMPLE_SPACING, crows_feet
from risorius.assets.identities.lines import ExpressionLines, Fan, Spread
from risorius.assets.loading import load
from tests.heads import person_of

PLAIN_LINES = ExpressionLines(
    seed=5,
    forehead=4,
    spread=Spread.WHOLE,
    dip=2.0,
    broken=0.0,
    forehead_depth=1.0,
    frown=2,
    uneven=0.0,
    frown_depth=1.0,
    feet=5,
    fan=Fan.WHOLE,
    reach=18.0,
    feet_depth=1.0,
    fold_depth=1.0,
    fine=0,
)


def people(age: float, sex: Sex | None = None) -> list[ExpressionLines]:
    """The lines of two hundred persons of one age."""
    return [sample_identity(seed, age=age, sex=sex).lines for seed in range(200)]


def drawn(shrink: int = 1, **own: object) -> np.ndarray:
    """The map of PLAIN_LINES with some fields of the lines replaced."""
    return with_lines(load("head").wrinkles, PLAIN_LINES._replace(**own), shrink).map.astype(int)


def about(name: str, high: int, wide: int) -> tuple[slice, slice]:
    """Rows and columns of the map around a named point, by half height and half width [texels]."""
    head = load("head")
    size = len(head.wrinkles.map)
    column, row = (head.uv[head.anatomy[name]] * [size, -size] + [0.0, size]).astype(int)
    return slice(row - high, row + high), slice(column - wide, column + wide)


def furrows_along(depth: np.ndarray) -> int:
    """The number of furrows crossed along each path, shape (n,)."""
    is_deep = np.concatenate([[False], depth > 40])
    return int((is_deep[1:] & ~is_deep[:-1]).sum())


def test_lines_get_more_and_deeper_with_age_and_in_men():
    """On average, lines are more and deeper at seventy than at twenty-five, and in men."""
    young = people(25.0)
    old = people(70.0)
    women = people(50.0, Sex.WOMAN)
    men = people(50.0, Sex.MAN)

    def mean(lines, name):
        """The mean of a field of some persons' lines."""
        return np.mean([getattr(each, name) for each in lines])

    for name in ("forehead", "feet", "reach", "fine"):
        assert mean(old, name) > mean(young, name)
    for name in ("forehead_depth", "frown_depth", "feet_depth", "fold_depth"):
        assert mean(old, name) > 1.3 * mean(young, name), name
        assert mean(men, name) > mean(women, name), name
    ratio_of_women = np.mean([each.forehead_depth / each.feet_depth for each in women])
    ratio_of_men = np.mean([each.forehead_depth / each.feet_depth for each in men])
    assert ratio_of_men > 1.05 * ratio_of_women


def test_patterns_have_their_published_frequencies():
    """Patterns of foreheads, frowns and crow's feet have nearly their published frequencies."""
    lines = people(50.0)
    spreads, frowns, fans = (
        Counter(getattr(x, name) for x in lines) for name in ("spread", "frown", "fan")
    )
    for kind, share in ((Spread.WHOLE, 0.51), (Spread.MIDDLE, 0.25), (Spread.SIDES, 0.24)):
        assert spreads[kind] / 200 == pytest.approx(share, abs=0.1)
    assert frowns[1] < 0.12 * 200 < 0.6 * 200 < frowns[2]
    for kind, share in ((Fan.WHOLE, 0.36), (Fan.LOWER, 0.31), (Fan.UPPER, 0.05)):
        assert fans[kind] / 200 == pytest.approx(share, abs=0.1)
    assert fans[Fan.CENTRAL] > 0.15 * 200


def test_a_number_has_the_same_lines_and_map_every_time():
    """Each number always has its own lines and map; maps shared between persons never change."""
    known = load("head").wrinkles
    before = known.map.copy()
    lines = [sample_identity(seed).lines for seed in (7, 7, 8)]
    assert lines[0] == lines[1] != lines[2]
    maps = [with_lines(known, each).map for each in lines]
    np.testing.assert_array_equal(maps[0], maps[1])
    forehead = about("metopion", 60, 150)
    others = [x[forehead][..., 2].astype(float).ravel() for x in maps[1:]]
    assert abs(np.corrcoef(*others)[0, 1]) < 0.5
    np.testing.assert_array_equal(known.map, before)
    assert not maps[0].flags.writeable


@pytest.mark.parametrize("count", [2, 4])
def test_as_many_lines_are_drawn_as_the_record_says(count):
    """Each map has the recorded number of lines, counted along paths across them.

    Paths run up the middle of the forehead, and from side to side between the brows.
    """
    rows, columns = about("metopion", 110, 60)
    counts = [
        furrows_along(depth)
        for seed in range(6)
        for depth in drawn(seed=seed, forehead=count)[rows, columns, 2].T[::8]
    ]
    assert np.median(counts) == count
    rows, columns = about("glabella", 12, 45)
    for frown in (1, 2, 3):
        across = drawn(frown=frown)[rows, columns, 2].max(axis=0)
        assert furrows_along(across) == frown


def test_spread_fan_and_reach_are_where_the_record_says():
    """Lines lie where recorded: in the middle or at the sides; crow's feet above or below.

    Their lengths are as recorded, too.
    """
    rows, columns = about("metopion", 60, 170)
    ways = (Spread.MIDDLE, Spread.SIDES)
    middle, sides = (drawn(spread=each)[rows, columns, 2].sum(axis=0) for each in ways)
    inner = slice(140, 200)
    assert middle[inner].mean() > 2.0 * middle[:80].mean()
    assert sides[80:120].mean() > 1.5 * sides[inner].mean()
    rows, columns = about("exocanthion_left", 110, 120)
    upper, lower = (drawn(fan=each)[rows, columns, 2] for each in (Fan.UPPER, Fan.LOWER))
    assert upper[:110].sum() > 2.0 * lower[:110].sum()
    assert lower[110:].sum() > 1.5 * upper[110:].sum()  # lower fans reach 6 degrees up
    short, long = (drawn(reach=reach)[rows, columns, 2].sum() for reach in (9.0, 20.0))
    assert long > 1.3 * short


def test_folds_have_the_recorded_depth_and_the_rest_stays():
    """Folds beside the mouth are 0.5 or 1.4 times as deep as built in, as recorded.

    Nose, lips, lower lids and chin are unchanged.
    """
    known = load("head").wrinkles.map.astype(int)
    shallow, deep = (drawn(fold_depth=depth) for depth in (0.5, 1.4))
    rows, columns = about("stomion", 60, 170)
    steep = np.abs(known[rows, columns, :2] - 128).max(axis=2) > 40
    steep[:, 90:250] = False
    for found, share in ((shallow, 0.5), (deep, 1.4)):
        slopes = np.abs(found[rows, columns, :2] - 128)[steep].sum()
        built_in = np.abs(known[rows, columns, :2] - 128)[steep].sum()
        assert slopes / built_in == pytest.approx(share, abs=0.2)
    for place, high, wide in (
        ("pogonion", 60, 120),
        ("labiale_superius", 12, 60),
        ("rhinion", 20, 60),
    ):
        near = about(place, high, wide)
        np.testing.assert_array_equal(deep[near], known[near])


def test_small_pictures_have_fewer_texels_of_the_same_lines():
    """A map with half the texels each way has the same depths and slopes.

    The smallest maps are shared between persons.
    """
    whole = drawn()
    half = drawn(2)
    assert half.shape == (640, 640, 4)
    means = whole.reshape(640, 2, 640, 2, 4).mean(axis=(1, 3))
    assert np.abs(means - half)[..., :3].mean() < 0.1
    assert np.corrcoef(means[..., 2].ravel(), half[..., 2].ravel())[0, 1] > 0.97
    person = person_of(6)
    small = coloured(person, angle=40.0, shrink=4).wrinkles.map
    below = slice(about("subnasale", 0, 0)[0].start // 4, None)  # below the lids
    assert_array_equal(small[below], shared_map(4)[below])
    assert len(coloured(person, angle=40.0, shrink=2).wrinkles.map) == 640
    bare = replace(person, identity=replace(person.identity, lines=None))
    unlined = coloured(bare, angle=40.0).wrinkles.map[4 * below.start :]
    assert_array_equal(unlined, bare.wrinkles.map[4 * below.start :])


def test_feet_of_crows_begin_and_end_gradually():
    """Most crow's feet change by less than 0.32 of their depth in a millimetre: no scratches."""
    changes = []
    for seed in range(20):
        for line in crows_feet(PLAIN_LINES, np.random.default_rng(seed)):
            steps = np.abs(np.diff(line.depth)) / SAMPLE_SPACING
            changes.append(steps.max() / line.depth.max())
    assert np.median(changes) < 0.32


def test_lines_between_the_brows_are_a_pair():
    """The shallower line is at least 0.45 times as deep as the other; it was 0.2 once."""
    assert max(each.uneven for each in people(40.0)) * 1.2 < 0.55


def test_a_frown_shows_no_line_across_the_forehead():
    """Lines of the forehead follow raised brows alone; a frown of person 18 showed a pale dash."""
    places = _line_regions(1)
    forehead = places.forehead
    slot = places.plain[forehead.rows, forehead.columns, 3]
    assert slot[forehead.texels[..., 3] > 0.99].max() == 0
