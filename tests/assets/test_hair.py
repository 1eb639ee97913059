"""Hair of persons: it grows on the scalp, lies on the head, and leaves the face free."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.ndimage import binary_dilation
from scipy.spatial import cKDTree

from risorius.app.anatomy import Anatomy, AnatomyView
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.passes.passes import Passes
from risorius.app.scenes import FaceScene
from risorius.assets import Segment
from risorius.assets.around import direction_coordinates
from risorius.assets.identities import (
    CUTS,
    HAIR,
    Person,
    coloured,
    make_person,
    person_called,
    sample_identity,
)
from risorius.assets.identities.hair import bared, grown
from risorius.assets.model import Part
from risorius.assets.solids import grid_faces
from risorius.geometry.normals import vertex_normals

COLOUR = np.array([0.3, 0.2, 0.15])
LONG = ("bob", "waves", "short")
HANGING = ("bob", "waves")


def passes_of(studio: Capture, wanted: Sequence[str]) -> dict[str, Any]:
    """The passes of these names of what was drawn last."""
    return Passes(studio.pipeline, studio.viewports[-1].drawn).draw(studio.camera, wanted)


@cache
def bare(number: int) -> Person:
    """Somebody without hair."""
    return make_person(sample_identity(number))


@cache
def hair_of(number: int, cut: str, receded: float = 0.0) -> tuple[Part, ...]:
    """A cut on somebody's head."""
    person = bare(number)
    return grown(cut, person.vertices, person.faces, COLOUR, receded=receded)


def points_of(parts: tuple[Part, ...]) -> npt.NDArray[np.float64]:
    """All vertices [mm]."""
    return np.vstack([part.vertices for part in parts]).astype(np.float64)


@pytest.mark.parametrize("cut", LONG)
@pytest.mark.parametrize("number", [0, pytest.param(5, marks=pytest.mark.slow)])
def test_hair_is_a_sound_part(number: int, cut: str) -> None:
    """Arrays fit each other, and triangles are seen from the side to which normals point."""
    for part in hair_of(number, cut):
        assert part.name.startswith(HAIR) and part.bone == "cranium"
        count = len(part.vertices)
        assert part.normals.shape == part.colours.shape == (count, 3)
        assert part.striation is not None and part.striation.shape == (count, 5)
        assert 0 <= part.faces.min() and part.faces.max() < count
        assert all(
            np.isfinite(each).all() for each in (part.vertices, part.colours, part.striation)
        )
        assert np.allclose(np.linalg.norm(part.normals, axis=1), 1.0, atol=1e-5)
        corners = part.vertices[part.faces].astype(np.float64)
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        agreeing = (facing * part.normals[part.faces].sum(axis=1)).sum(axis=1)
        assert (agreeing > 0.0).mean() > 0.97  # some bands are turned over at the crown


@pytest.mark.parametrize("cut", LONG)
@pytest.mark.parametrize("number", [0, pytest.param(5, marks=pytest.mark.slow)])
def test_the_face_is_free(number: int, cut: str) -> None:
    """No hair hangs before brows, eyes, nose and mouth."""
    person, points = bare(number), points_of(hair_of(number, cut))
    face = person.vertices[person.landmarks[17:68]]
    low, high = face.min(axis=0), face.max(axis=0)
    is_before = ((points > low) & (points < high + np.array([0.0, 2.0, 60.0]))).all(axis=1)
    assert not is_before.any()


@pytest.mark.parametrize("cut", LONG)
def test_hair_lies_on_the_head(cut: str) -> None:
    """It begins on the scalp, and hardly any of it is within the head."""
    person, locks = bare(0), hair_of(0, cut)[0]
    look = CUTS[cut]
    assert look is not None
    rows = locks.vertices.reshape(look.count, look.look.rows, 3, 3)
    tree, normals = cKDTree(person.vertices), vertex_normals(person.vertices, person.faces)

    def heights(points: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
        """Over the skin, about [mm]."""
        nearest = tree.query(points)[1]
        return ((points - person.vertices[nearest]) * normals[nearest]).sum(axis=1)

    # Behind the ears the nearest vertex tells nothing.
    assert np.quantile(np.abs(heights(rows[:, 0, 1])), 0.95) < 4.5
    assert (heights(rows[:, 2:, 1].reshape(-1, 3)) > -1.5).mean() > 0.98


def test_cuts_differ_in_length() -> None:
    """Hair that hangs covers the ears; short hair leaves them free; cropped hair is painted."""
    ears = bare(0).vertices[[bare(0).anatomy[f"tragion_{side}"] for side in ("left", "right")]]
    for cut in HANGING:
        assert points_of(hair_of(0, cut))[:, 1].min() < ears[:, 1].min() - 30.0
    beside = points_of(hair_of(0, "short"))
    beside = beside[(np.abs(beside[:, 2] - ears[0, 2]) < 8.0) & (np.abs(beside[:, 0]) > 60.0)]
    assert beside[:, 1].min() > ears[:, 1].max()
    assert hair_of(0, "cropped") == ()


def test_a_hairline_recedes() -> None:
    """What has receded begins farther back."""
    usual, receded = (hair_of(0, "short", by)[0].vertices for by in (0.0, 20.0))
    assert receded[:, 2].max() < usual[:, 2].max() - 5.0


def test_hair_is_the_same_every_time_and_follows_the_tone() -> None:
    """A person has one hair, in the colour of the tone, however often it is coloured."""
    ada, again = person_called("ada"), person_called("ada")
    mine, other = ([p for p in each.parts if p.name.startswith(HAIR)] for each in (ada, again))
    assert len(mine) == len(other) == 2
    for one, two in zip(mine, other, strict=True):
        assert np.array_equal(one.vertices, two.vertices)
        assert np.array_equal(one.colours, two.colours)
    darker = coloured(ada, angle=-50.0)
    hair = [part for part in darker.parts if part.name.startswith(HAIR)]
    assert len(hair) == 2 and hair[0].colours.mean() < 0.8 * mine[0].colours.mean()
    assert not [p for p in person_called("kofi").parts if p.name.startswith(HAIR)]


def test_hair_keeps_its_colour_in_other_tones_of_skin() -> None:
    """Scalp under hair and brows stay as they are; the skin changes, at the parting too."""
    ada, uncoloured = person_called("ada"), bare(0)
    assert ada.in_tone is not None and uncoloured.in_tone is None
    change = np.abs(ada.in_tone(-40.0).astype(float) - ada.albedo).mean(axis=2)
    size = change.shape[0]
    places = ada.uv[ada.face_uv].astype(np.float64)
    cut = CUTS["bob"]
    bare_there = bared(cut, ada.vertices, ada.faces, places, (size, size)) > 0.9
    assert 0 < bare_there.sum() < 0.002 * size * size
    assert not bared(CUTS["short"], ada.vertices, ada.faces, places, (size, size)).any()
    is_scalp = binary_dilation(bare_there, iterations=12)
    is_scalp &= ~binary_dilation(bare_there, iterations=8)
    assert change[bare_there].mean() > 30.0 > 10.0 > np.median(change[is_scalp])


def test_hair_is_seen_framed_and_labelled() -> None:
    """It is in the picture as a whole, has its class, and is away where muscles are shown."""
    scene = FaceScene(person_called("ada"))
    assert scene.fade is None  # the shirt covers the end of the neck
    top = max(part.vertices[:, 1].max() for part in scene.parts if part.name.startswith(HAIR))
    assert scene.framed[:, 1].max() >= top
    options = CaptureOptions(size=(160, 160), passes=("segmentation",))
    with Capture(scene, options) as capture:
        capture.draw_image()
        classes = passes_of(capture, ("segmentation",))["segmentation"]
    assert (classes == Segment.HAIR).mean() > 0.08
    assert (classes[0] == Segment.BACKGROUND).all()
    parts = Anatomy(scene).layers(AnatomyView(("muscles",))).parts
    assert parts and not [part for part in parts if part.name.startswith(HAIR)]


def test_hair_throws_its_shadow_on_skin(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cheek beside a bob toward the key light is darker for it; the other one, and hair, not.

    Locks do not stripe each other.
    """
    with Capture(
        FaceScene(person_called("ada")),
        CaptureOptions(size=(240, 296), camera="0,0,0.9", passes=("segmentation",)),
    ) as capture:
        within = capture.draw_image().astype(float)
        classes = passes_of(capture, ("segmentation",))["segmentation"]
        monkeypatch.setattr(capture.pipeline.renderer, "cast_shadows", lambda *_, **__: None)
        without = capture.draw_image().astype(float)
    darker = (without - within).mean(axis=2)
    is_hair = classes == Segment.HAIR
    is_skin = classes == Segment.SKIN
    beside = is_skin & binary_dilation(is_hair, iterations=3)
    beside[:100] = beside[180:] = False  # from the brows to the chin
    toward, away = darker[:, :120][beside[:, :120]], darker[:, 120:][beside[:, 120:]]
    assert (toward > 12.0).mean() > 0.4 and toward.mean() > 12.0
    assert np.abs(away).mean() < 1.0
    assert np.abs(darker[is_skin & ~binary_dilation(is_hair, iterations=20)]).mean() < 0.5
    assert np.abs(darker[is_hair]).mean() < 2.0


@pytest.mark.parametrize("cut", LONG)
def test_what_is_left_out_of_locks_is_covered(cut: str) -> None:
    """Straight from outside, nothing lies over the head where all locks would, and less is left."""
    look, (locks, lining) = CUTS[cut], hair_of(0, cut)
    assert look is not None
    whole = 4 * look.count * (look.look.rows - 1)
    assert 0.2 * whole < len(locks.faces) < 0.85 * whole
    every = grid_faces(look.look.rows, 3)
    every = (every + np.arange(look.count)[:, None, None] * 3 * look.look.rows).reshape(-1, 3)

    def outermost(faces: npt.NDArray[np.int32]) -> dict[tuple[float, float], float]:
        """How far out the middles of faces reach, over places."""
        middles = [locks.vertices[faces].mean(axis=1), lining.vertices[lining.faces].mean(axis=1)]
        angle, height, radius = direction_coordinates(np.vstack(middles).astype(np.float64))
        found: dict[tuple[float, float], float] = {}
        for *place, far in zip(np.round(8.0 * angle), np.round(height / 8.0), radius, strict=True):
            found[tuple(place)] = max(found.get(tuple(place), 0.0), float(far))
        return found

    kept, all_of_them = outermost(locks.faces), outermost(every)
    off = [far - kept.get(place, 0.0) for place, far in all_of_them.items()]
    assert np.quantile(off, 0.95) < 1.0


def test_skin_near_hair_gets_less_light_from_all_around() -> None:
    """Under hair little is left of it, beside hair some is missing, the nose has all it had."""
    ada = person_called("ada")
    height, width = ada.ambient_occlusion.shape
    missing = (bare(0).ambient_occlusion.astype(float) - ada.ambient_occlusion) / 255.0
    assert bare(0).ambient_occlusion.shape == (height, width) and missing.min() >= 0.0
    uv = np.zeros((len(ada.vertices), 2))
    uv[ada.faces] = ada.uv[ada.face_uv]

    def missing_at(vertex: int) -> float:
        """How much the hair takes away at a vertex."""
        u, v = uv[vertex]
        return float(missing[int((1.0 - v) * height), int(u * width)])

    assert missing_at(int(ada.landmarks[30])) < 0.02
    assert missing_at(ada.anatomy["temple_left"]) > 0.3
    assert 0.02 < missing_at(ada.anatomy["trichion"])
    assert np.array_equal(person_called("kofi").ambient_occlusion, bare(0).ambient_occlusion)
