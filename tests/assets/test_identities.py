"""Persons: heads with the requested measures, and faces that move like the built-in one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.linalg import norm
from pytest import approx

from risorius import sim
from risorius.app.cli.value_types import HEAD_NAMES
from risorius.app.scenes import FaceScene
from risorius.assets.coarse import COARSE_NAME
from risorius.assets.fitting.mesh_validation import SkinPiece, check_manifold, check_openings
from risorius.assets.identities import (
    NAMED_PERSONS,
    Person,
    Sex,
    make_person,
    person_called,
    sample_identity,
)
from risorius.assets.identities.space import person_space, scores_of
from risorius.assets.loading import load
from risorius.assets.norms import NORMS, measures_of
from risorius.bench.gaps import eyeballs_of, lid_gaps, widest_slit
from risorius.geometry.directions import unit_vectors
from risorius.geometry.intersections import self_intersections
from tests.assets.checks import mirror_error
from tests.heads import person_of
from tests.sim.poses import advance, inverted_triangles

SEEDS = st.integers(0, 2**32 - 1)
PERSONS = (0, 1039)


@pytest.fixture(scope="module", params=PERSONS)
def person(request: pytest.FixtureRequest) -> Person:
    """A few persons."""
    return make_person(sample_identity(request.param))


@pytest.mark.parametrize("side", ["left", "right"])
def test_no_ridge_runs_down_from_the_inner_brow(side):
    """On person 19, skin bends by at most 12 degrees over an edge from inner brow to lid."""
    person = person_called(19)
    head = load("head")
    edge = np.array([769, 571])  # vertices of the right brow and lid, and their neighbours
    beside = np.array([570, 742])
    if side == "left":
        edge = head.mirror[edge]
        beside = head.mirror[beside]
    brow, lid = person.vertices[edge]
    along = unit_vectors(brow - lid)
    sides = person.vertices[beside] - lid
    one, other = unit_vectors(sides - (sides @ along)[:, None] * along)
    assert np.degrees(np.arccos(-one @ other)) < 12.0


def test_the_border_of_a_thin_lower_lip_is_smooth(head):
    """No vertex leaves the line between its neighbours by 0.58 mm more than the built-in head's.

    On person 18 one left it by 0.7 mm, and light showed the lip's border as a jagged line.
    """
    change = person_called(18).vertices - head.vertices
    for ring in (4, 5, 6):
        left, right = (head.rings[f"mouth_{ring}_{side}"][8:] for side in ("left", "right"))
        border = change[np.r_[left, right[-2::-1]]]
        between_neighbours = 0.5 * (border[2:] + border[:-2])
        assert norm(border[1:-1] - between_neighbours, axis=1).max() < 0.58


def test_few_persons_lie_far_from_the_mean():
    """The root mean square of a person's weights is about 1.4, and above 2 for 1 person in 100."""
    weights = np.array([sample_identity(n).weights for n in range(400)])
    sizes = np.sqrt(np.square(weights).mean(axis=1))
    assert 1.3 < np.median(sizes) < 1.6
    assert np.mean(sizes > 2.0) < 0.03


@given(SEEDS)
@settings(max_examples=4, deadline=None)
def test_a_number_is_one_person(seed):
    """A number always gives the same bytes, and no person exceeds the allowed deviations."""
    first = sample_identity(seed)
    second = sample_identity(seed)
    assert first == second
    assert np.abs(first.weights).max() <= 4.0
    a = make_person(first)
    b = make_person(second)
    assert a.vertices.tobytes() == b.vertices.tobytes()
    for one, other in zip(a.parts, b.parts, strict=True):
        assert one.vertices.tobytes() == other.vertices.tobytes()


@given(SEEDS)
@settings(max_examples=4, deadline=None)
def test_an_even_face_is_its_own_mirror_image(seed):
    """A symmetric face equals its mirror image within rounding.

    An asymmetric face differs from its mirror image by some millimetres.
    """
    even = make_person(sample_identity(seed, is_even=True))
    assert mirror_error(even.vertices, even.mirror) < 1e-6
    assert np.abs(even.vertices[even.mirror == np.arange(len(even.mirror)), 0]).max() < 1e-6
    uneven = person_of(seed)
    assert 0.1 < mirror_error(uneven.vertices, uneven.mirror) < 8.0


def test_persons_are_spread_as_published():
    """Among 400 persons, sexes differ nearly as published, and long faces have long noses.

    Persons are not a sample of the people behind these norms, but vary around them.
    """
    space = person_space()
    everyone = [sample_identity(seed) for seed in range(400)]
    means = {}
    for sex in Sex:
        mine = [each for each in everyone if each.sex is sex and each.age < 40.0]
        found = [
            measures_of(space.mean + space.moved(np.array(each.weights)), space.anatomy)
            for each in mine
        ]
        table = np.array([list(scores_of(measures, sex).values()) for measures in found])
        assert np.abs(table.mean(axis=0)).mean() < 0.8, sex
        assert 0.8 < table.std(axis=0).mean() < 1.25, sex
        assert table.mean(axis=0)[list(NORMS).index("sn-prn")] < 1.0, sex
        related = dict(zip(NORMS, np.corrcoef(table.T), strict=True))
        assert related["n-sn"][list(NORMS).index("n-prn")] > 0.5
        means[sex] = {code: np.mean([measures[code] for measures in found]) for code in NORMS}
    for code in ("n-gn", "al-al", "zy-zy", "go-go", "ch-ch"):
        published = NORMS[code].men.mean - NORMS[code].women.mean
        assert means[Sex.MAN][code] - means[Sex.WOMAN][code] > 0.4 * published, code


def test_women_and_men_differ_as_measured():
    """Mean women and men, alike except for sex, differ nearly as published.

    Men's brows lie lower and farther out, relative to the corners of the eyes. Women's necks are a
    sixth narrower.
    """
    space = person_space()
    faces = {}
    for sex in Sex:
        weights = [space.draw(sex, 30.0, np.random.default_rng(k)) for k in range(20)]
        faces[sex] = space.mean + space.moved(np.mean(weights, axis=0))
    found = {sex: measures_of(face, space.anatomy) for sex, face in faces.items()}
    for code in ("n-gn", "n-sn", "sn-sto", "sn-ls", "al-al", "zy-zy", "go-go", "ex-ex"):
        published = NORMS[code].men.mean - NORMS[code].women.mean
        assert 0.5 < (found[Sex.MAN][code] - found[Sex.WOMAN][code]) / published < 1.5, code
    corner = space.anatomy["exocanthion_left"]
    man, woman = (faces[sex] - faces[sex][corner] for sex in (Sex.MAN, Sex.WOMAN))
    brow = load("head").landmarks[24]
    assert 1.5 < woman[brow, 1] - man[brow, 1] < 4.0
    assert 3.0 < man[brow, 2] - woman[brow, 2] < 6.0


def test_womens_necks_are_narrower():
    """Women's necks are a sixth narrower, as published, if everything else is equal."""
    identity = sample_identity(4, is_even=True)
    her, him = (make_person(replace(identity, sex=sex)) for sex in (Sex.WOMAN, Sex.MAN))
    is_neck = him.vertices[:, 1] < him.vertices[him.anatomy["menton"], 1] - 40.0
    shares = np.ptp(her.vertices[is_neck, 0]) / np.ptp(him.vertices[is_neck, 0])
    assert shares == approx(0.83, abs=0.02)


@pytest.mark.parametrize("number", [8, 66])
def test_womens_necks_have_no_corner(number):
    """From behind, the side of a woman's neck turns by less than 15 degrees at each vertex."""
    behind_jaw = [176, 271, 195, 64]  # vertices from the ear down to the neck's end
    down = np.diff(person_called(number).vertices[behind_jaw, :2], axis=0)
    turns = np.diff(np.degrees(np.arctan2(down[:, 0], -down[:, 1])))
    assert np.abs(turns).max() < 15.0


def test_most_variance_needs_eight_components():
    """90 % of the variance of a hundred faces needs at least eight principal components.

    Fewer components would mean that persons are of three or four types.
    """
    space = person_space()
    identities = [sample_identity(k) for k in range(100)]
    x = np.array([space.moved(np.array(identity.weights)) for identity in identities])
    face = space.mean[:, 2] > 40.0
    off = (x - x.mean(axis=0))[:, face].reshape(100, -1)
    shares = np.linalg.svd(off, compute_uv=False) ** 2
    assert (np.cumsum(shares) / shares.sum() < 0.9).sum() + 1 >= 8


def test_age_has_visible_effects():
    """With age lips get thinner and the skin above them longer; furrows show at rest."""
    young, old = (make_person(sample_identity(4, age=age)) for age in (25.0, 70.0))
    assert old.measures["ls-sto"] < young.measures["ls-sto"] - 0.5
    assert old.measures["sn-ls"] > young.measures["sn-ls"] + 0.5
    assert young.wrinkles.resting.max() == 0.0 < old.wrinkles.resting.max() < 1.0


def test_persons_of_one_age_and_sex_differ_in_small_things():
    """Persons of one age and sex differ in lids, corners of the mouth, brows and furrows.

    Each varies by a good part of its mean spread.
    """
    alike = [sample_identity(seed, sex=Sex.WOMAN, age=60.0) for seed in range(40)]
    for name, least in (("covered", 0.3), ("corners", 0.45), ("brows", 0.8), ("furrows", 0.25)):
        assert np.std([getattr(each, name) for each in alike]) > least, name
    deep, shallow = (replace(alike[0], furrows=share) for share in (1.5, 0.5))
    resting = [make_person(each).wrinkles.resting.max() for each in (deep, shallow)]
    assert resting[0] == approx(3.0 * resting[1])


def test_furrows_of_old_persons_differ_in_place():
    """Two equally old persons have furrows in different places, such as forehead or mouth.

    Both halves of a face are alike.
    """
    persons = [make_person(sample_identity(number, age=70.0)) for number in (1, 2)]
    shares = [each.wrinkles.resting / each.wrinkles.resting.max() for each in persons]
    assert abs(np.corrcoef(*shares)[0, 1]) < 0.8
    for person, share in zip(persons, shares, strict=True):
        assert share.std() > 0.1
        assert share[person.mirror] == approx(share, abs=1e-5)


def test_weights_vary_as_much_as_peoples():
    """Weights vary at least as much as people's in every direction, except in the head's size."""
    weights = np.array(
        [sample_identity(seed, sex=Sex.MAN, age=30.0).weights for seed in range(300)]
    )
    spread = weights.std(axis=0)
    assert 0.5 < spread[0] < 1.1
    assert spread[1:].min() > 0.85
    assert spread[1:].max() < 2.0


def test_upper_lids_cover_a_part_of_the_iris():
    """Upper lids cover half a millimetre to three of the iris, and lower lids touch it.

    With less, a person would stare.
    """
    for seed in range(8):
        person = person_of(seed)
        for eye in person.eyes:
            lids = [person.anatomy[f"palpebrale_{lid}erius_{eye.name}"] for lid in ("sup", "inf")]
            off = np.abs(person.vertices[lids, 1] - eye.centre[1])
            assert 0.4 < eye.iris_radius - off[0] < 3.2
            assert abs(eye.iris_radius - off[1]) < 1.0


@pytest.mark.slow
def test_named_persons_are_different_people(head):
    """Named persons differ in sex, tone and age, and none has the built-in head's face."""
    people = [person_called(name) for name in NAMED_PERSONS]
    assert HEAD_NAMES == (*NAMED_PERSONS, COARSE_NAME)
    assert {each.identity.sex for each in people} == set(Sex)
    assert np.ptp([each.identity.age for each in people]) > 30.0
    for i, each in enumerate(people):
        assert all(abs(score) < 3.0 for score in each.scores.values())
        for other in (*people[:i], head):
            assert norm(each.vertices - other.vertices, axis=1).mean() > 1.0
            assert (each.albedo.astype(int) - other.albedo).std() > 5.0


def test_person_is_a_sound_head(person, head):
    """No triangle is turned over or crosses another.

    Eyes and mouth are open enough to be fitted.
    """
    check_manifold(person.faces)
    check_openings(
        SkinPiece(
            person.vertices,
            person.faces,
            person.landmarks,
            person.file_vertices,
            np.arange(len(person.faces)),
        )
    )
    assert inverted_triangles(person.faces, head.vertices, person.vertices) == 0
    assert len(self_intersections(person.vertices, person.faces)) == 0
    assert not np.shares_memory(person.vertices, head.vertices)
    for old, new in zip(head.eyes, person.eyes, strict=True):
        for row in ("eye_1", "eye_2"):  # lids are as far from their eye as built in
            ring = np.delete(head.rings[f"{row}_{old.name}"], [0, 10])
            before, now = (
                norm(x[ring] - eye.centre, axis=1) / eye.radius
                for x, eye in ((head.vertices, old), (person.vertices, new))
            )
            np.testing.assert_allclose(now, before, rtol=1e-9)


def test_expressions_work_on_persons(person, head, request):
    """A person is still at rest, with closed lips; expressions move it as they move the head."""
    simulation = sim.create(person)
    usual = sim.create(head)
    advance(simulation, 30)
    assert np.abs(simulation.positions - simulation.rest_positions).max() < 0.01
    landmarks = simulation.positions[person.landmarks]
    assert widest_slit(simulation.positions, simulation.faces, landmarks) < 0.15
    for pose, share in (("joy", 0.6), ("surprise", 0.6), ("jaw_open", 0.6), ("blink", 0.7)):
        moved = []
        for each in (simulation, usual):
            each.reset()
            each.controls.pose({pose: 1.0})
            advance(each, 60)
            moved.append(norm(each.positions - each.rest_positions, axis=1).max())
        assert np.isfinite(simulation.positions).all()
        assert share < moved[0] / moved[1] < 1.0 / share, pose
    landmarks = simulation.positions[person.landmarks]
    shown = simulation.positions, simulation.faces, landmarks, eyeballs_of(person, simulation)
    # On the most unusual person, skin is hidden past the inner corner of the lids when seen from
    # below; in a picture no eye shows there: test_passes.py.
    if request.node.callspec.params["person"] != PERSONS[-1]:
        assert max(lid_gaps(*shown).values()) < 0.3


def test_person_is_a_scene(person, head):
    """A scene accepts a person like any head, lit at once like the built-in head."""
    scene = FaceScene(person)
    assert scene.skin.ambient_occlusion is person.ambient_occlusion
    assert scene.skin.albedo.shape == head.albedo.shape
    scene.pose({"joy": 1.0})
    scene.step(0.1)
    assert np.isfinite(scene.positions).all()
