"""The graphics card makes the same frames as the processor: splits, triangles and rows.

They are equal to the bit if the driver rounds like the processor (agreement.py).
"""

import copy

import numpy as np
import pytest

from risorius import refine, sim
from risorius.assets.model import Head
from risorius.geometry.arrays import Floats64
from risorius.refine_gl import KahlerGl
from tests import meshes
from tests.refine.cases import edge_count_of
from tests.sim.poses import advance

from .agreement import LOOK_OPTIONS, RULES, assert_same, bound_twice

POSES = ("rest", "joy", "anger", "yawn", "kiss")
VIEW = refine.View((3.0, 2.0, 20.0))
FAR_OFFSET = np.array([700.0, -300.0, 900.0])
QUICK_POSES = ("joy", "kiss far away")
both_rules = pytest.mark.parametrize("rules", ["two levels", "window's look"])


@pytest.fixture(scope="module")
def poses(head: Head) -> dict[str, Floats64]:
    """The head's vertices by name of the pose; one pose is turned and far from the origin."""
    found = {}
    face = sim.create(head)
    for name in POSES:
        face.reset()
        if name != "rest":
            face.controls.set(name, 1.0)
        advance(face, 60)
        found[name] = face.positions.copy()
    found["kiss far away"] = found["kiss"] @ meshes.rotation(3).T + FAR_OFFSET
    return found


def with_seam(head):
    """Texture coordinates with an artificial seam at x = 0."""
    is_left = head.vertices[head.faces].mean(axis=1)[:, 0] > 0
    uv = np.random.default_rng(1).random((len(head.vertices), 2))
    return {
        "uv": np.vstack([uv, uv + 2.0]),
        "face_uv": head.faces + len(head.vertices) * is_left[:, None],
    }


@pytest.mark.parametrize("rules", RULES)
@pytest.mark.parametrize("is_seamed", [False, True], ids=["whole", "seam"])
@pytest.mark.parametrize(
    "pose",
    [
        name if name in QUICK_POSES else pytest.param(name, marks=pytest.mark.slow)
        for name in (*POSES, "kiss far away")
    ],
)
def test_head(pose, is_seamed, rules, head, poses):
    """Every pose of the head, with a texture seam and without, for one and two levels."""
    values = with_seam(head) if is_seamed else {}
    processor, card = bound_twice(head.faces, head.vertices, **RULES[rules], **values)
    mesh = assert_same(processor, card, poses[pose])
    is_split = pose != "rest" or rules == "window's look"
    assert card.splits.max() == ((1 if rules == "one level" else 2) if is_split else 0)
    refine.check(card, mesh, poses[pose])


@pytest.mark.parametrize("scheme", ["loop", "cubic"])
def test_splits_that_stay(scheme):
    """With given splits all frames have the same triangles, on the card and on the processor."""
    mesh = meshes.irregular(7)
    edge_count = edge_count_of(mesh)
    splits = np.random.default_rng(3).integers(0, 3, edge_count)
    processor, card = bound_twice(mesh.faces, mesh.vertices, scheme=scheme, splits=splits)
    seen = set()
    for seed in range(2):
        refined = assert_same(processor, card, meshes.wrinkled(mesh, seed))
        seen.add(refined.triangles.tobytes())
        assert (card.splits == splits).all()
    assert len(seen) == 1


@both_rules
@pytest.mark.parametrize("name", meshes.NAMED_MESHES)
def test_small_meshes(name, rules):
    """Three frames of each test mesh: borders, fins, flips, doubles, debris."""
    mesh = meshes.NAMED_MESHES[name]()
    processor, card = bound_twice(mesh.faces, mesh.vertices, **RULES[rules])
    for seed, amplitude in ((0, 0.0), (1, 0.5), (2, 0.2)):
        positions = meshes.wrinkled(mesh, seed, amplitude)
        refine.check(card, assert_same(processor, card, positions), positions)


@both_rules
def test_attributes(rules):
    """Texture coordinates and other values at corners are interpolated equally.

    Rows may be wide.
    """
    mesh = meshes.tube()
    assert mesh.uv is not None
    assert mesh.face_uv is not None
    generator = np.random.default_rng(5)
    values = {"colour": generator.random((len(mesh.vertices), 3)), "id": (mesh.uv, mesh.face_uv)}
    processor, card = bound_twice(
        mesh.faces,
        mesh.vertices,
        uv=mesh.uv,
        face_uv=mesh.face_uv,
        attributes=values,
        **RULES[rules],
    )
    for seed in range(3):
        got = assert_same(processor, card, meshes.wrinkled(mesh, seed, 0.6))
        assert got.attributes["colour"].shape == (got.vertex_count, 3)


@both_rules
@pytest.mark.parametrize("side", [30, 100, pytest.param(330, marks=pytest.mark.slow)])
def test_sums_over_many_groups(side, rules):
    """In grids of up to 217 800 triangles, numbers continue across groups of threads."""
    mesh = meshes.open_grid(side, side)
    x, y, _ = mesh.vertices.T
    height = 2.0 * np.sin(0.9 * x) * np.sin(0.7 * y) * x / side
    processor, card = bound_twice(mesh.faces, mesh.vertices, **RULES[rules])
    got = assert_same(processor, card, np.column_stack([x, y, height]))
    assert got.triangle_count > 1.5 * len(mesh.faces)


@pytest.mark.parametrize(
    "options",
    [
        {"criterion": "normal+rest"},
        {"criterion": "normal+displacement", "scheme": "cubic"},
        {"criterion": ["displacement", refine.Silhouette(), refine.RestCurvature()], "blend": True},
        {"criterion": refine.Displacement(0.02, 0.1, turning=0.0), "blend": False},
        {"criterion": "normal", "threshold_twice": np.inf, "scheme": "cubic"},
        {"criterion": "silhouette"},
    ],
)
def test_criteria(options):
    """The card computes some criteria and their combinations; the processor computes the others."""
    options = {"scheme": "cubic" if "blend" in options else "loop", **options}
    mesh = meshes.irregular(7, 8, 6, 1)
    card, processor = (
        refine.create(name, mesh.faces, mesh.vertices, **copy.deepcopy(options))
        for name in ("kahler-gl", "kahler")
    )
    assert isinstance(card, KahlerGl)
    for seed in range(3):
        positions = meshes.wrinkled(mesh, seed, 0.3 * seed)
        refine.check(card, assert_same(processor, card, positions, VIEW), positions)


def random_mesh(seed):
    """A bumpy grid with holes, or any triangles over any vertices; some with texture seams."""
    generator = np.random.default_rng(seed)
    if seed % 2:
        mesh = meshes.irregular(seed, *generator.integers(2, 14, 2), holes=seed % 4)
    else:
        count = generator.integers(3, 60)
        face_count = generator.integers(1, 200)
        faces = generator.integers(0, count, (face_count, 3)).astype(np.int32)
        mesh = meshes.Mesh(generator.normal(size=(count, 3)), faces)
    options = {"threshold_once": 0.1, "threshold_twice": 0.6} if seed % 3 else {}
    if seed % 5 == 0:
        options["face_uv"] = generator.integers(0, 4, mesh.faces.shape)
        options["uv"] = generator.random((4, 2))
    if seed % 7 == 0:
        options["coherent"] = True
    elif seed % 2 == seed // 2 % 2:
        options |= LOOK_OPTIONS | {"blend": None if seed % 3 else False}
    return mesh, options


def assert_random_meshes_same(seeds):
    """Check two frames of a mesh for each seed; return the configurations that occurred."""
    met = set()
    for seed in seeds:
        mesh, options = random_mesh(seed)
        processor, card = bound_twice(mesh.faces, mesh.vertices, **options)
        for frame in range(2):
            assert_same(processor, card, meshes.wrinkled(mesh, seed + frame, 0.5))
        splits = np.append(processor.splits, 0)[processor.triangle_edges].astype(int)
        met |= set((splits @ [1, 3, 9]).tolist())
    return met


def test_random_meshes():
    """All 27 configurations occur; meshes are non-manifold, with seams, and split coherently."""
    assert assert_random_meshes_same(range(40)) == set(range(27))


@both_rules
@pytest.mark.parametrize("frames", [60, pytest.param(500, marks=pytest.mark.slow)])
def test_coherent_frames(frames, rules, head):
    """In a moving face, the states of triangles stay on the card, and equal the processor's."""
    face = sim.create(head)
    processor, card = bound_twice(head.faces, head.vertices, coherent=True, **RULES[rules])
    for frame in range(frames):
        for place, name in enumerate(("joy", "anger", "yawn")):
            face.controls.set(name, float(frame // 20 % 3 == place))
        face.step(1 / 60)
        assert_same(processor, card, face.positions)
    assert isinstance(processor, refine.Kahler)
    assert card.removals_out_of_order == processor.cutting.removals_out_of_order > 0


@pytest.mark.parametrize("rules", ["two levels", "window's look"])
def test_points_that_nothing_uses(rules):
    """Unused points that are far away or NaN change nothing, even if they come first."""
    mesh = meshes.irregular(4)
    strays = np.array([[np.nan, 0.0, 0.0], [1e14, 0.0, 0.0]])
    rest = np.concatenate([strays, mesh.vertices])
    bent = np.concatenate([strays, meshes.wrinkled(mesh, 5)])
    processor, card = bound_twice(mesh.faces + len(strays), rest, **RULES[rules])
    got = assert_same(processor, card, bent)
    alone = refine.create("kahler", mesh.faces, mesh.vertices, **RULES[rules])
    wanted = alone.refine(bent[len(strays) :])
    np.testing.assert_array_equal(got.positions[got.triangles], wanted.positions[wanted.triangles])
