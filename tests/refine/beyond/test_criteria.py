"""Criteria besides the paper's, alone and combined."""

import numpy as np
import pytest
from numpy.linalg import norm

from risorius import refine
from risorius.geometry.directions import unit_vectors
from risorius.geometry.sides import side_lengths
from tests import meshes
from tests.refine.cases import Forced, kahler, scheme_of, sound_frame


def splits_of(mesh, deformed, criterion, **view):
    """Splits of every edge, and the edges."""
    refiner = kahler(mesh, criterion=criterion)
    refiner.refine(deformed, **view)
    return refiner.splits.copy(), refiner.edges


def test_rest_by_hand():
    """The criterion `rest` splits curved places of a tube by height and length of the arc.

    It splits the same edges for every deformation and view.
    """
    tube = meshes.tube(24, 4)
    around = 2 * np.sin(np.pi / 24)
    edges = refine.connect(tube.faces, len(tube.vertices)).edges
    size = norm(np.ptp(tube.vertices, axis=0))
    measure = around**2 / 8 / size * np.cbrt(40.0 * around / size)
    for factor, expected in ((0.9, 1), (1.1, 0)):
        refiner = refine.create(
            "kahler", tube.faces, tube.vertices,
            criterion=refine.RestCurvature(factor * measure, 1.0),
        )  # fmt: skip
        is_around = edges[:, 0] // 24 == edges[:, 1] // 24
        is_inner = (edges >= 24).all(axis=1) & (edges < 24 * 4).all(axis=1)
        along = edges[:, 0] % 24 == edges[:, 1] % 24
        for positions in (tube.vertices, meshes.wrinkled(tube, 3), tube.vertices[:, [1, 2, 0]]):
            mesh = refiner.refine(positions, view=refine.View([0.0, 9.0, 0.0]))
            refine.check(refiner, mesh, positions)
            assert (refiner.splits[is_around & is_inner] == expected).all()
            assert not refiner.splits[along].any()


def test_rest_is_grown_at_once():
    """Points that exist at rest have the same place with blending and without."""
    sphere = meshes.ball(1)
    points = []
    for blend in (False, True):
        refiner = kahler(sphere, criterion="rest", scheme="cubic", blend=blend)
        mesh = refiner.refine(sphere.vertices)
        points.append({tuple(row) for row in mesh.positions.round(5).tolist()})
    assert len(points[0]) > len(sphere.vertices)
    assert points[0] < points[1]  # a blended mesh also has points in the middle of triangles


def test_view_is_needed():
    """A criterion that depends on the eye raises an error without a view."""
    mesh = meshes.octahedron()
    refiner = kahler(mesh, criterion="silhouette")
    with pytest.raises(ValueError, match=r"needs the place of the eye; pass view=refine.View"):
        refiner.refine(mesh.vertices)
    for view in (refine.View([0, 0, np.nan]), refine.View([0, 0]), refine.View(5)):
        with pytest.raises(ValueError, match="a finite eye of shape"):
            refiner.refine(mesh.vertices, view=view)


def test_maximum():
    """A list of criteria splits each edge as often as its most demanding criterion."""
    mesh = meshes.irregular(1)
    deformed = meshes.wrinkled(mesh, 2)
    view = refine.View([0.0, 0.0, 50.0])
    names = ["normal", "rest", "silhouette"]
    single = [splits_of(mesh, deformed, name, view=view)[0] for name in names]
    together, _ = splits_of(mesh, deformed, names, view=view)
    assert (together == np.max(single, axis=0)).all()
    assert len({s.tobytes() for s in single}) == 3
    assert len(set(together.tolist())) == 3
    joined, _ = splits_of(mesh, deformed, "+".join(names), view=view)
    assert (joined == together).all()


def test_blended_splits_are_the_same():
    """Blending does not change how often an edge is split."""
    mesh = meshes.irregular(2)
    deformed = meshes.wrinkled(mesh, 3)
    splits = []
    for blend in (False, True):
        refiner = kahler(mesh, blend=blend)
        refiner.refine(deformed)
        splits.append(refiner.splits.copy())
    assert (splits[0] == splits[1]).mean() > 0.998
    assert len(set(splits[0].tolist())) == 3


@pytest.mark.parametrize("blend", [False, True])
def test_one_level_only(blend):
    """An infinite second threshold disables the second level, with blending and without."""
    mesh = meshes.irregular(2)
    refiner = kahler(mesh, threshold_twice=np.inf, blend=blend)
    refiner.refine(meshes.wrinkled(mesh, 3, 1.0))
    assert refiner.splits.max() == 1


EYE = np.array([3.0, 2.0, 4.0])


def plain_measure(kind, positions, normals, edges, most):
    """The measure of a criterion at every edge, in a second, simple implementation."""
    values = []
    for a, b in edges:
        cosine = float(normals[a] @ normals[b])
        if kind is refine.NormalDrop:
            values.append(-cosine)
        else:
            facing_a, facing_b = (
                float(normals[end] @ unit_vectors(EYE - positions[end])) for end in (a, b)
            )
            is_outline = facing_a * facing_b <= 0
            aside = 0.0 if is_outline else min(abs(facing_a), abs(facing_b))
            values.append(min(1 - cosine, most) * max(0.0, 1 - aside / 0.3))
    return np.array(values)


@pytest.mark.parametrize("level", ["both", "first only"])
@pytest.mark.parametrize(
    ("kind", "once", "twice"),
    [
        (refine.NormalDrop, 0.02, 0.08),
        (refine.Silhouette, 0.005, 0.03),
    ],
)
def test_needs_by_hand(kind, once, twice, level):
    """A metric is the measure minus `once`, divided by the distance of both thresholds.

    With an infinite second threshold the divisor is the first threshold.
    """
    mesh = meshes.irregular(2)
    deformed = meshes.wrinkled(mesh, 3)
    none = refine.create("none", mesh.faces, mesh.vertices)
    connectivity = refine.connect(mesh.faces, len(mesh.vertices))
    edges = connectivity.edges
    at_rest = none.refine(mesh.vertices).normals.copy()
    now = none.refine(deformed).normals.copy()
    width = twice - once if level == "both" else once
    most = once + 1.25 * width  # here points of both levels are at their final places
    expected = plain_measure(kind, deformed, now.astype(float), edges, most)
    if kind is refine.NormalDrop:
        expected -= plain_measure(kind, mesh.vertices, at_rest.astype(float), edges, most)

    criterion = kind(once, twice if level == "both" else np.inf)
    criterion.bind(connectivity, mesh.vertices, at_rest)
    criterion.set_view(refine.View(EYE))
    metric = np.zeros(len(edges), dtype=np.float32)
    criterion.measure(deformed, now, metric)
    wanted = np.minimum((expected - once) / width, np.inf if level == "both" else 1.0)
    np.testing.assert_allclose(metric, wanted, rtol=1e-4, atol=1e-3)
    assert 0.05 < (metric > 0).mean() < 0.95
    splits = np.zeros(len(edges), dtype=np.uint8)
    criterion.mark(deformed, now, splits)
    clear = (abs(metric) > 1e-3) & ((abs(metric - 1) > 1e-3) | (level == "first only"))
    assert clear.sum() > 0.5 * len(edges)
    count = (metric > 0).astype(int) + (metric > 1)
    np.testing.assert_array_equal(splits[clear], count[clear])


@pytest.mark.parametrize("scheme", ["cubic", "detail"])
def test_displacement(scheme):
    """An edge is split if its fully displaced middle is far enough from the chord.

    For an edge on a border, an eighth of the threshold counts.
    """
    mesh = meshes.irregular(2)
    deformed = meshes.wrinkled(mesh, 3)
    connectivity = refine.connect(mesh.faces, len(mesh.vertices))
    edges = connectivity.edges
    full = kahler(
        mesh,
        scheme=scheme_of(scheme, mesh.vertices + 0.01, mesh.faces),
        blend=False,
        criterion=Forced(np.ones(len(edges))),
    ).refine(deformed)
    middles = full.positions[len(mesh.vertices) :]
    heights = norm(middles - deformed[edges].mean(axis=1), axis=1)
    unit = side_lengths(mesh.vertices, edges).mean()
    once, twice = np.quantile(heights, [0.4, 0.8])
    heights = np.where(connectivity.around.is_interior, heights, 8.0 * heights)
    refiner = kahler(
        mesh,
        scheme=scheme_of(scheme, mesh.vertices + 0.01, mesh.faces),
        criterion=[refine.Displacement(once / unit, twice / unit, turning=0.0)],
    )
    sound_frame(refiner, deformed)
    expected = (heights > once).astype(int) + (heights > twice)
    assert (refiner.splits == expected).mean() > 0.99
    assert set(refiner.splits.tolist()) == {0, 1, 2}


def test_displacement_needs_measures():
    """The paper's scheme has no measure of displacement and is refused.

    With refined normals the scheme has one.
    """
    mesh = meshes.octahedron()
    with pytest.raises(ValueError, match='LoopScheme does so with normals="refined" only'):
        kahler(mesh, criterion="displacement")
    refiner = kahler(mesh, criterion=refine.Displacement(0.05, 0.5), normals="refined")
    refiner.refine(mesh.vertices)
    assert (refiner.splits > 0).all()


def test_an_overridden_method_is_used():
    """A subclass that replaces `mark` is used, alone and in a list."""
    mesh = meshes.irregular(4)

    class Everything(refine.NormalDrop):
        def mark(self, positions, normals, splits):
            splits[:] = 2

    for criterion in (Everything(), ["rest", Everything()]):
        refiner = kahler(mesh, criterion=criterion)
        refiner.refine(mesh.vertices)
        assert (refiner.splits == 2).all()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"criterion": refine.Criterion()}, "Criterion must have a method measure"),
        ({"scheme": refine.Scheme()}, "Scheme must have a method place"),
    ],
)
@pytest.mark.parametrize("name", ["kahler", "kahler-gl"])
def test_a_missing_method_is_reported(name, options, text):
    """A criterion or scheme without its required method is reported by name in a frame."""
    mesh = meshes.octahedron()
    if name == "kahler-gl" and "scheme" in options:
        pytest.skip("the card has schemes of its own")
    refiner = refine.create(name, mesh.faces, mesh.vertices, **options)
    with pytest.raises(NotImplementedError, match=text):
        refiner.refine(mesh.vertices)


class Heat(refine.Criterion):
    """A user's criterion that divides zero by zero at one edge."""

    def __init__(self, at, frame=0):
        self.at = at
        self.frame = frame

    def measure(self, positions, normals, metric):
        """Write NaN, from a given frame on."""
        metric[:] = 0.5
        if self.frame <= 0:
            metric[self.at] = np.nan
        self.frame -= 1


class Warmth(Heat):
    """A criterion whose `mark` is correct, but whose `measure`, used for blending, writes NaN."""

    def mark(self, positions, normals, splits):
        """Split no edge."""
        splits[:] = 0


@pytest.mark.parametrize("blend", [False, True])
@pytest.mark.parametrize("name", ["kahler", "kahler-gl"])
@pytest.mark.parametrize("is_part", [False, True])
def test_no_number_is_reported(blend, name, is_part):
    """The first frame with a NaN metric reports the criterion's name, alone or in a list."""
    mesh = meshes.irregular(3)
    for first in (0, 2):
        heat = Heat(7, first)
        asks = ["normal", heat] if is_part else heat
        scheme = "cubic" if blend else "loop"
        options = {"criterion": asks, "blend": blend, "scheme": scheme}
        refiner = refine.create(name, mesh.faces, mesh.vertices, **options)
        for _ in range(first):
            refiner.refine(mesh.vertices)
        with pytest.raises(
            ValueError, match=r"criterion Heat measures NaN for 1 of \d+ edges, .* 7;"
        ):
            refiner.refine(mesh.vertices)


def test_check_reports_what_would_be_no_number():
    """`check` also calls `measure` of a criterion with its own `mark`, and reports NaN."""
    mesh = meshes.irregular(3)
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, criterion=Warmth(7))
    refined = refiner.refine(mesh.vertices)
    with pytest.raises(refine.BrokenMeshError, match="criterion Warmth measures NaN for 1 of"):
        refine.check(refiner, refined, mesh.vertices)
