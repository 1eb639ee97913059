"""Skin of any tone and eyes of any colour, computed from one number."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius.assets.identities import (
    DARKEST_TONE,
    LIGHTEST_TONE,
    Features,
    Sex,
    coloured,
    colours_of_number,
    complexion,
    drawn_irises,
    features_of,
    in_colours,
    person_called,
    recoloured,
    sample_identity,
    with_colours_of_number,
)
from risorius.assets.identities.brows import Brows, stubble
from risorius.assets.identities.complexion import (
    _distances_behind_hairline,
    _tints_of_size,
)
from risorius.assets.identities.eyes import Iris, drawn_iris
from risorius.assets.identities.hairline import Hairline
from risorius.assets.identities.population import IRIS_FREQUENCIES
from risorius.assets.model import Segment
from risorius.assets.pigments import SHIPPED_COMPLEXION, typology_angle
from risorius.assets.smooth import shrunk
from risorius.geometry.colour import to_linear, to_screen
from tests.heads import person_of

TONES = (70.0, 55.0, 41.0, 28.0, 10.0, -10.0, -30.0, -55.0)
TONE_ANGLES = st.floats(DARKEST_TONE, LIGHTEST_TONE)


def light_at(head, image, *names):
    """The median of linear light around anatomical points, shape (3,)."""
    height, width = image.shape[:2]
    found = []
    for name in names:
        u, v = head.uv[head.anatomy[name]]
        x = int(u * width)
        y = int((1.0 - v) * height)
        found.append(image[y - 5 : y + 6, x - 5 : x + 6].reshape(-1, 3))
    return np.median(to_linear(np.concatenate(found) / 255.0), axis=0)


def skin_of(head, image):
    """The colours of bare skin at the forehead and the temples."""
    return light_at(head, image, "metopion", "temple_left", "temple_right")


def test_own_tone_is_the_shipped_picture(head):
    """With the tone of the stored picture, the face equals the file byte by byte.

    Nape and sides of the neck have no shadow of a shaved beard.
    """
    tints = _tints_of_size()
    angle = np.interp(-SHIPPED_COMPLEXION.melanin, -tints.melanins, tints.angles)
    size = len(head.albedo)
    rows = slice(round(0.35 * size), round(0.83 * size))
    columns = slice(round(0.25 * size), round(0.75 * size))
    made = recoloured(float(angle))
    assert (made[rows, columns] == head.albedo[rows, columns]).all()


def test_tones_are_in_order(head):
    """The typology angle measured on bare skin is near the requested one.

    A darker tone is darker everywhere.
    """
    pictures = {angle: recoloured(angle) for angle in TONES}
    found = {angle: float(typology_angle(skin_of(head, x))) for angle, x in pictures.items()}
    for angle, measured in found.items():
        assert abs(measured - angle) < 9.0
    for lighter, darker in pairwise(TONES):
        assert found[lighter] > found[darker]
        assert (skin_of(head, pictures[lighter]) > skin_of(head, pictures[darker])).all()
        assert (pictures[lighter].astype(int) - pictures[darker]).min() >= -1


@pytest.mark.slow
@given(TONE_ANGLES)
@settings(max_examples=12, deadline=None)
def test_faces_keep_their_features(head, angle):
    """In any tone, lips are redder than skin, brows and nostrils darker; skin is never grey."""
    image = recoloured(angle)
    skin = skin_of(head, image)
    lips = light_at(head, image, "labiale_superius")  # on the border, where half is red
    mucosa = to_linear(image[_texel(head, image, head.rings["mouth_4_left"][0])] / 255.0)
    assert mucosa[0] / mucosa[1] > 1.12 * skin[0] / skin[1]
    assert lips[0] / lips[1] > skin[0] / skin[1]
    brow = to_linear(image[head.segments == Segment.LEFT_BROW] / 255.0).mean(axis=0)
    assert brow.sum() < skin.sum()
    nostril = to_linear(image[_texel(head, image, head.anatomy["nostril_roof_left"])] / 255.0)
    assert nostril.sum() < 0.8 * skin.sum()
    assert skin[0] > 1.25 * skin[1] > 1.25 * skin[2]


def _texel(head, image, vertex):
    """Row and column of a vertex in the map."""
    u, v = head.uv[vertex]
    return int((1.0 - v) * image.shape[0]), int(u * image.shape[1])


@pytest.mark.parametrize("angle", [DARKEST_TONE - 1.0, LIGHTEST_TONE + 1.0, float("nan")])
def test_no_other_tones(angle):
    """An invalid tone is refused in one line with the allowed values."""
    with pytest.raises(ValueError, match="it must be -55 "):
        recoloured(angle)


def test_eyes_have_their_colours(head):
    """Blue irises are bluest, brown ones reddest and darkest; only irises change."""
    person = person_of(1)
    iris = {}
    for name in IRIS_FREQUENCIES:
        eyed = coloured(person, angle=40.0, irises=name)
        for old, new in zip(person.parts, eyed.parts, strict=False):
            changed = (np.abs(old.colours - new.colours) > 0.01).any(axis=1)
            assert changed.any() == old.name.startswith("eyeball")
            if changed.any():
                eye = next(each for each in person.eyes if old.bone == f"eye_{each.name}")
                aside = np.linalg.norm((old.vertices - eye.centre)[:, :2], axis=1)
                assert aside[changed].max() < 1.3 * eye.iris_radius
                iris[name] = new.colours[(aside > 2.5) & (aside < 5.0) & changed].mean(axis=0)
    names = list(iris)
    red, green, blue = np.array([*iris.values()]).T
    assert names[np.argmin(red / blue)] == "blue"
    assert names[np.argmax(red / blue)] == "brown"
    assert names[np.argmin(red + green + blue)] == "brown"
    assert names[np.argmax(green / (red + blue))] == "green"
    with pytest.raises(ValueError, match="allowed are brown, hazel"):
        coloured(person, angle=40.0, irises="red")


@pytest.mark.slow
def test_colours_of_a_number(head):
    """A number always gives the same colours; dark skin goes with brown eyes."""
    person = person_of(0)
    first, second = (with_colours_of_number(person, 5) for _ in range(2))
    assert (first.albedo == second.albedo).all()
    assert (first.parts[0].colours == second.parts[0].colours).all()
    brown = coloured(person, angle=40.0, irises="brown").parts[0].colours
    others = [
        coloured(person, angle=40.0, irises=name).parts[0].colours for name in IRIS_FREQUENCIES
    ]
    is_iris = (np.abs(others[0] - others[1]) > 0.01).any(axis=1)

    def redness(colours):
        """The ratio of red to blue in the irises."""
        red, _, blue = colours[is_iris].mean(axis=0)
        return red / blue

    tanned = 0
    for seed in range(12):
        one = with_colours_of_number(person, seed)
        if typology_angle(skin_of(head, one.albedo)) < 0.0:
            tanned += 1
            assert redness(one.parts[0].colours) > 0.6 * redness(brown) > 1.0
    assert 2 <= tanned <= 10


def test_bands_of_texels_have_the_colours_of_the_whole(monkeypatch):
    """Colouring in bands equals colouring at once, byte by byte, for any number of rows."""
    colours = colours_of_number(sample_identity(3), 3)
    given = {"features": colours.features, "haired_as": colours.angle, "shrink": 2}
    usual = recoloured(colours.angle, **given)
    for rows in (37, 640):
        monkeypatch.setattr(complexion, "BAND_ROWS", rows)
        assert (recoloured(colours.angle, **given) == usual).all()


def test_a_hairline_is_moved_on_the_scalp_alone():
    """A shifted hairline moves only texels of the scalp, by the plain formula."""
    line = Hairline(front=4.0, temples=7.0, crown=0.6)
    tints = _tints_of_size()
    plain = np.float32(complexion.SCALP_SCALE) * tints.scalp - np.float32(complexion.SCALP_OFFSET)
    moved = (plain - line.shift(len(plain))) / np.float32(1.6)
    wanted = np.where(tints.scalp > 0.01, moved, plain)
    assert (_distances_behind_hairline(tints, Features(hairline=line)) == wanted).all()


def test_the_hem_of_painted_hair_is_single_hairs():
    """Near the hairline, single painted hairs differ from the mean colour.

    Skin and dense hair are unchanged.
    """
    behind = _distances_behind_hairline(_tints_of_size(), Features())
    plain, fringed = (
        recoloured(40.0, haired_as=40.0, fringe=fringe).astype(int).sum(axis=2)
        for fringe in (0.0, 1.0)
    )
    change = fringed - plain
    hem = (behind > 3.0) & (behind < 9.0)
    assert change[hem].std() > 30.0
    assert abs(change[hem].mean()) < 0.2 * change[hem].std()
    assert not change[behind <= 0.0].any()
    assert np.abs(change[behind >= 22.0]).max() <= 3


def test_old_skin_has_no_white_scratches_beside_former_hair():
    """Skin where hair has fallen out has no bright lines.

    Gaps between the picture's hairs were lighter by 26 % on a bald forehead.
    """
    person = person_called(47)
    size = len(person.albedo)
    column, row = (person.uv[person.anatomy["trichion"]] * [size, -size] + [0, size]).astype(int)
    near = person.albedo[row - 50 : row + 60, column - 200 : column + 200].mean(axis=2)
    assert (near / scipy.ndimage.median_filter(near, 15)).max() < 1.12


def test_eyes_go_with_dark_skin():
    """With dark skin, corners, wet edges and whites of the eyes are darker.

    Irises are unchanged.
    """
    person = person_of(1)
    light, dark = (
        {part.name: part.colours for part in coloured(person, angle=angle).parts}
        for angle in (45.0, -40.0)
    )
    for name in ("eye_corners", "wet_edges"):
        assert dark[name].mean() < 0.6 * light[name].mean()
    share = (dark["eyeball_left"] / light["eyeball_left"]).mean(axis=1)
    assert 0.7 < share.min() < 0.9
    assert share.max() == 1.0


def test_no_two_irises_are_alike():
    """Irises of one colour differ in lightness and in the ring around the pupil."""
    person = person_of(1)
    random = np.random.default_rng(2)
    drawn = [Features(iris=drawn_iris(30.0, chance, random)) for chance in random.random(8)]
    eyes = [coloured(person, angle=45.0, irises="blue", features=f).parts[0].colours for f in drawn]
    assert np.ptp([each.mean() for each in eyes]) > 0.02
    spread = np.std(eyes, axis=0).mean(axis=1)
    assert (spread > 0.03).sum() > 100


def test_irises_differ_in_fibres_and_edges():
    """Another seed puts an iris's fibres in other places; a limbus darkens only the edge."""
    person = person_of(1)

    def light_of(**own):
        """Light of the vertices of the left eyeball."""
        features = Features(iris=Iris(**own))
        eyes = coloured(person, angle=45.0, irises="blue", features=features).parts
        return {part.name: part.colours.mean(axis=1) for part in eyes}["eyeball_left"]

    plain = light_of()
    dark = light_of(limbus=1.0)
    first = light_of(fibres=0.4, seed=1) - plain
    second = light_of(fibres=0.4, seed=2) - plain
    is_iris = first != 0.0
    assert is_iris.sum() > 400
    assert abs(np.corrcoef(first[is_iris], second[is_iris])[0, 1]) < 0.3
    assert 0.02 < np.std(first[is_iris]) < 0.12
    assert 100 < (dark < plain - 0.02).sum() < 250
    assert (dark[~is_iris] == plain[~is_iris]).all()


def test_the_dark_edge_of_irises_fades_with_age():
    """With the same random numbers, young persons have a darker limbus than old ones."""
    ages = 20.0, 75.0
    young, old = (drawn_iris(years, 0.5, np.random.default_rng(1)) for years in ages)
    assert young.limbus > old.limbus + 0.3
    assert young.fibres == old.fibres


@pytest.mark.parametrize("angle", [60.0, 0.0, -50.0])
def test_irises_have_the_given_frequencies_where_skin_is_light(angle):
    """In light skin, iris colours are as frequent as given; dark skin has brown only."""
    random = np.random.default_rng(3)
    drawn = [drawn_irises(random, angle, {"brown": 1.0, "blue": 3.0}) for _ in range(400)]
    assert (0.68 < drawn.count("blue") / 400 < 0.82) if angle > 28.0 else set(drawn) == {"brown"}


@pytest.mark.slow
def test_each_feature_has_its_effect(head):
    """Each feature has its effect on brow shape, beard, lips, or hair."""
    plain = recoloured(40.0).astype(int)

    def changed(**features):
        """Mean change of the picture in each segment, indexed by its number; shape (16, 3)."""
        off = recoloured(40.0, features=Features(**features)).astype(int) - plain
        return np.array([off[head.segments == n].mean(axis=0) for n in range(1, 14)])

    brow = Segment.LEFT_BROW - 1
    lip = Segment.TOP_LIP - 1
    thin, thick = (Brows(wide, 11.0, 3.0, 8.0, 40.0, 1.0, 0.2, 1) for wide in (4.0, 9.0))
    assert changed(brows=thin)[brow].mean() > 4.0 + changed(brows=thick)[brow].mean()
    assert not changed(brows=thin)[lip].any()
    assert changed(beard=0.5)[Segment.NECK - 1].mean() < changed(beard=0.5)[brow].mean()
    reddened = changed(lips=0.3)[lip]
    assert reddened[1] < -7.5
    assert reddened[0] > -4.0
    assert changed(grey=0.9)[Segment.HAIR - 1].mean() > 15.0
    receded = Features(hairline=Hairline(front=20.0), brows=thick)
    usual, balder = (recoloured(40.0, features=f, haired_as=40.0) for f in (Features(), receded))
    assert (balder.astype(int) - usual)[head.segments == Segment.HAIR].mean() > 1.0
    bald = coloured(person_of(1), angle=40.0, features=receded).segments
    assert (bald == Segment.HAIR).sum() < (head.segments == Segment.HAIR).sum()
    for side in (Segment.LEFT_BROW, Segment.RIGHT_BROW):
        assert 0.4 < (bald == side).sum() / (head.segments == side).sum() < 2.5


def test_lips_differ_by_person(head):
    """The redness of lips differs between persons by a good part of its mean.

    The feature `pale_lips` lightens lips in dark skin, and changes nothing in light skin.
    """
    random = np.random.default_rng(3)
    woman, man = (sample_identity(1, sex=sex, age=30.0) for sex in (Sex.WOMAN, Sex.MAN))
    drawn = {who: [features_of(who, -40.0, random) for _ in range(80)] for who in (woman, man)}
    blood = {who: [each.lips for each in found] for who, found in drawn.items()}
    assert np.mean(blood[woman]) > np.mean(blood[man]) + 0.3
    assert np.std(blood[woman]) > 0.15
    assert np.std(blood[man]) > 0.1
    assert np.std([each.pale_lips for each in drawn[woman]]) > 0.1
    pale = Features(pale_lips=0.4)
    assert (recoloured(65.0, features=pale) == recoloured(65.0)).all()
    off = recoloured(-40.0, features=pale).astype(int) - recoloured(-40.0)
    assert off[head.segments == Segment.TOP_LIP].mean() > 5.0
    assert np.abs(off[head.segments == Segment.NECK]).max() == 0
    red, green, _ = off[head.segments == Segment.TOP_LIP].mean(axis=0)
    assert red > 1.7 * green  # pink: a uniform lighter skin colour was wrong


def test_men_who_tie_their_hair_have_kept_it():
    """Hairlines of old men recede, unless their hair is tied: a tail hung from bald heads."""
    old = sample_identity(4, sex=Sex.MAN, age=70.0)
    places = {}
    for cut in ("short", "tailed", "knotted"):
        random = np.random.default_rng(5)
        drawn = [features_of(replace(old, cut=cut), 20.0, random).hairline for _ in range(80)]
        places[cut] = np.array([(line.front, line.temples, line.crown) for line in drawn])
    assert places["short"][:, :2].sum(axis=1).max() > 30.0
    for cut in ("tailed", "knotted"):
        assert places[cut][:, :2].sum(axis=1).max() < 20.0
        assert (places[cut][:, 2] == 0.0).all()


def test_tied_hair_is_dense_at_the_hairline():
    """Persons with tied hair show no bare forehead behind their first hairs, in labels, too.

    Their foreheads were 70 mm high, and those of women with loose hair 64 mm.
    """
    person = person_called(91000039)
    features = colours_of_number(person.identity, 91000039).features
    assert features.hairline.tied > 0.0
    untied = replace(person.identity, cut="parted")
    assert colours_of_number(untied, 91000039).features.hairline.tied == 0.0
    loose = replace(features, hairline=replace(features.hairline, tied=0.0))
    rows = []
    for each in (loose, features):
        segments = coloured(person, angle=0.0, features=each).segments
        middle = segments[:, len(segments) // 2 - 20 : len(segments) // 2 + 20]
        rows.append(np.flatnonzero((middle == Segment.HAIR).all(axis=1)).max())
    assert rows[1] > rows[0] + 12


def test_hair_turns_grey_as_in_the_survey():
    """A quarter of the hair turns grey between 45 and 65 years, less with dark skin.

    The young have no grey hair.
    """

    def grey(angle, years):
        """The mean fraction of grey hair of persons with these ages and equal other features."""
        random = np.random.default_rng(2)
        ages = random.uniform(*years, 300)
        drawn = [sample_identity(1, age=float(age)) for age in ages]
        return float(np.mean([features_of(each, angle, random).grey for each in drawn]))

    assert 0.2 < grey(50.0, (45.0, 65.0)) < 0.34
    assert grey(-40.0, (45.0, 65.0)) < 0.6 * grey(50.0, (45.0, 65.0))
    assert grey(50.0, (20.0, 30.0)) == 0.0
    assert grey(50.0, (72.0, 75.0)) > 0.7


@pytest.mark.parametrize("number", [3, 8])
def test_small_pictures_have_the_same_colours_of_fewer_texels(number):
    """A small picture has the mean light of the blocks of the picture at full size.

    Hair and classes are the same.
    """
    person = person_of(number)
    colours = colours_of_number(person.identity, number)
    whole = in_colours(person, colours)
    small = in_colours(person, colours, shrink=4)
    assert small.albedo.shape == (320, 320, 3)
    assert small.ambient_occlusion.shape == (320, 320)
    light = shrunk(to_linear(whole.albedo / 255.0).astype(np.float32), 4)
    off = np.abs(to_screen(light) - small.albedo / 255.0)
    assert off.mean() < 0.004
    assert np.percentile(off, 99.0) < 0.04
    assert (whole.segments == small.segments).all()
    for one, other in zip(whole.parts, small.parts, strict=True):
        assert (one.vertices == other.vertices).all()


def test_stubble_is_finer_than_texels():
    """A hair covers a part of a texel, so its neighbours differ; stubble was large black dots."""
    hairs = stubble(1280)[850:1050, 540:740]
    assert 0.1 < hairs.mean() < 0.4
    assert hairs.max() < 0.6
    across = np.corrcoef(hairs[:, 1:].ravel(), hairs[:, :-1].ravel())[0, 1]
    assert across < 0.2


def test_no_beard_grows_on_the_nape():
    """The map of the beard, which also colours shaved skin, ends in front of the neck.

    Full beards showed a grey pentagon on the nape, which lies above the scalp in the texture.
    """
    beard = _tints_of_size().beard
    above_scalp = beard[: len(beard) // 3]
    assert above_scalp.max() == 0.0
    assert beard.max() > 0.9
