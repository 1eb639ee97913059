"""Search for gaps between shut lips or lids, inverted triangles and deep contacts.

The benchmark sets each row of every layer to full strength, and then hundreds of random mixtures of
muscles, and lets the built-in head settle in each pose. It counts inverted triangles, which are
turned by more than a right angle against the skin around them. It measures the depth of skin inside
the other lip, an eyeball or the teeth.

Action units and expressions in which the mouth or an eye is shut have two more measures. The first
is the widest slit between lips that no muscle opens. The second is the greatest visible height of a
shut eyeball, or of the open space beside it. The views cover the whole front: 60 degrees to either
side, and 40 up and down. The mesh and the refined mesh are both measured, because smoothing thins a
folded lip a little; the larger gap counts. Gaps are measured by lines of sight, not by distances
between vertices: a gap without a line of sight does not count, and a gap may lie between two
touching vertices.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from risorius import assets, refine, sim
from risorius.app.dataset.openings import LOWER_EDGES, around, cut_by, opening, to_viewer
from risorius.app.refining.presets import FIRST_PRESET, PRESETS
from risorius.geometry.arrays import Floats64
from risorius.geometry.normals import cross_products
from risorius.geometry.transforms import moved_points

from .report import Target, at_most, table
from .subjects import settled_positions

Triangles = npt.NDArray[Any]

LARGEST_FAULTS = {"slit": 0.2, "eye": 0.2, "lips": 0.1, "lids": 0.1, "teeth": 0.1}  # mm
CAMERA_YAWS = (0.0, -30.0, 30.0, -60.0, 60.0)  # degrees
CAMERA_PITCHES = (0.0, -10.0, 10.0, -25.0, 25.0, -40.0, 40.0)
CAMERA_ANGLES = tuple(  # the whole range of the cameras
    (yaw, pitch)
    for yaw, pitch in itertools.product(CAMERA_YAWS, CAMERA_PITCHES)
    if (yaw / 60.0) ** 2 + (pitch / 40.0) ** 2 < 1.3
)


class MeasuredPose(NamedTuple):
    """The faults of one pose; None if lips or eyes need not be shut."""

    name: str
    slit: float | None  # mm, widest between the lips
    eye: float | None  # mm, greatest visible height of a shut eye
    inverted: int  # triangles
    lips: float  # mm deep in the other lip
    lids: float  # mm deep in an eyeball
    teeth: float  # mm deep in the teeth


def measure(mixtures: int) -> list[MeasuredPose]:
    """Set the built-in head to each pose, and to this number of random mixtures."""
    head = assets.load("head")
    simulation = sim.create(head)
    options = PRESETS[FIRST_PRESET]["face"].options_for("kahler")
    refiner = refine.create("kahler", head.faces, head.vertices, **options)
    poses = []
    settling_frames = 45  # frames of 1/60 s until a pose is still
    seed = 2001
    for name, values in _values(simulation, mixtures, np.random.default_rng(seed)):
        now = settled_positions(simulation, values, settling_frames)
        gaps = _gaps(head, simulation, refiner, name)
        inverted = inverted_count(simulation.rest_positions, now, head.faces)
        deep = simulation.anatomy.penetrations()
        poses.append(MeasuredPose(name, *gaps, inverted, deep["lips"], deep["lids"], deep["teeth"]))
    return poses


def _gaps(
    head: Any, simulation: sim.Simulation, refiner: refine.Refiner, name: str
) -> tuple[float | None, float | None]:
    """The slit between shut lips, and the visible height of a shut eye, in a pose [mm]."""
    sums = simulation.controls.sums
    moved = {control for control, value in sums.items() if value != 0.0}
    # Only the turn of the head is set.
    is_turned = moved and all(control.startswith("head_") for control in moved)
    layer = "Action units"
    mouth_shut = (
        "sadness",
        "anger",
        "contempt",
        "wink",
        "kiss",
        "blink",
        "viseme_sil",
        "viseme_PP",
    )
    eyes_shut = ("yawn",)  # with an open mouth
    if is_turned or name not in (*simulation.controls.layers[layer], *mouth_shut, *eyes_shut):
        return None, None
    # FACS: these part the lips; all others leave the mouth shut.
    lip_parting = ("AU9", "AU10", "AU16", "AU22", "AU25", "AU26", "AU27")
    is_shut = name.removesuffix("_left").removesuffix("_right") not in lip_parting + eyes_shut
    landmarks = simulation.positions[head.landmarks]
    shut_value = 0.99  # least activation of a shut eye
    closing_muscle = "orbicularis_oculi_palpebral_upper"
    shut = [side for side in ("right", "left") if sums[f"{closing_muscle}_{side}"] >= shut_value]
    slits = []
    eyes = []
    for positions, triangles in meshes_of(simulation, refiner).values():
        if is_shut:
            slits.append(widest_slit(positions, triangles, landmarks))
        if shut:
            gaps = lid_gaps(positions, triangles, landmarks, eyeballs_of(head, simulation))
            eyes += [gaps[side] for side in shut]
    return max(slits, default=None), max(eyes, default=None)


def _values(
    simulation: sim.Simulation, mixtures: int, generator: np.random.Generator
) -> Iterator[tuple[str, dict[str, float]]]:
    """Name and values of every row of every layer, then of random mixtures."""
    controls = simulation.controls
    for names_of_layer in controls.layers.values():
        yield from ((name, {name: 1.0}) for name in names_of_layer)
    # The pose of the head turns all triangles equally, so it is left out.
    limits = {n: controls.limits[n] for n in controls.lowest if not n.startswith("head_")}
    names = np.array(list(limits))
    most_controls = 8  # in one mixture
    for number in range(mixtures):
        chosen = generator.choice(
            names, size=generator.integers(2, most_controls + 1), replace=False
        )
        values = {str(name): float(generator.uniform(*limits[str(name)])) for name in chosen}
        yield f"mixture {number}: {', '.join(values)}", values


def meshes_of(
    simulation: sim.Simulation, refiner: refine.Refiner
) -> dict[str, tuple[Floats64, Triangles]]:
    """Positions [mm] and triangles of the simulated mesh ("static") and the refined mesh
    ("refined").
    """
    drawn = refiner.refine(simulation.positions)
    return {
        "static": (simulation.positions, simulation.faces),
        "refined": (drawn.positions.astype(np.float64), drawn.triangles),
    }


def widest_slit(positions: Floats64, triangles: Triangles, landmarks: Floats64) -> float:
    """Greatest height [mm] of a visible slit between the lips, in any of CAMERA_ANGLES.

    landmarks: the 68 points in this pose, (68, 3) [mm].
    """
    lip = landmarks[list(LOWER_EDGES["mouth"])]
    mouth_radius = 60.0  # mm around the mouth's middle in which skin may cover it
    near = around(positions[triangles], (lip[0] + lip[-1]) / 2.0, mouth_radius)
    turns = [_turned_by(*view) for view in CAMERA_ANGLES]
    return max(opening(near @ turn.T, lip @ turn.T) for turn in turns)


def _turned_by(yaw: float, pitch: float) -> Floats64:
    """Rotation that brings the view from `yaw`, `pitch` [degrees] to the front."""
    about_y_then_x = Rotation.from_euler("yx", [yaw, pitch], degrees=True)
    return np.asarray(about_y_then_x.as_matrix())


def eyeballs_of(head: Any, simulation: sim.Simulation) -> dict[str, Floats64]:
    """Triangles (n, 3, 3) of the head's eyeballs with their current turn, by side."""
    bones = simulation.bones.transforms()
    found = {}
    for part in head.parts:
        if part.name.startswith("eyeball_"):
            turn = np.asarray(bones[part.bone], dtype=np.float64)
            vertices = moved_points(turn, part.vertices)
            found[part.bone.removeprefix("eye_")] = vertices[part.faces]
    return found


def lid_gaps(
    positions: Floats64, triangles: Triangles, landmarks: Floats64, eyeballs: Mapping[str, Floats64]
) -> dict[str, float]:
    """Greatest height [mm] of each eyeball, or of open space beside it, from CAMERA_ANGLES.

    A place is visible if no skin is in front of it. It may be visible between the lids, or where
    the cornea pierces a lid. `landmarks`: the 68 points in this pose, (68, 3) [mm]; `eyeballs`: see
    `eyeballs_of`. The keys of the result are the sides of the eyes.
    """
    turns = [_turned_by(*view) for view in CAMERA_ANGLES]
    gaps = {}
    eye_radius = 100.0  # mm around the eye's middle in which skin may cover it
    eye_corners = {"right": (36, 39), "left": (42, 45)}  # landmarks
    for side, numbers in eye_corners.items():
        ends = landmarks[list(numbers)]
        ball = eyeballs[side]
        near = around(positions[triangles], ends.mean(axis=0), eye_radius)
        gaps[side] = max(_lid_gap(near @ turn.T, ends @ turn.T, ball @ turn.T) for turn in turns)
    return gaps


def _lid_gap(near: Floats64, ends: Floats64, ball: Floats64) -> float:
    """Greatest height [mm] without skin between the corners of an eye (2, 3), along z.

    Only a gap with skin above and below it counts.
    """
    near = near[to_viewer(near)]
    left, right = np.sort(ends[:, 0])
    middle = ends[:, 1].mean()
    deepest = ball[:, :, 2].min()
    lid_step = 0.05  # mm between lines of sight in a plane
    lid_window = 12.0  # mm above and below the eye's middle
    heights = np.arange(middle - lid_window, middle + lid_window, lid_step)
    widest = 0
    lid_columns = 23  # planes across an eye
    lid_end = 1.5  # [mm] near the corners of an eye that are not tested
    for x in np.linspace(left + lid_end, right - lid_end, lid_columns):
        covered = _frontmost_depths(near, x, heights) >= np.maximum(
            _frontmost_depths(ball, x, heights), deepest
        )
        skin = np.flatnonzero(covered)  # in the outermost planes there may be no skin
        if len(skin):
            widest = max(widest, int((~covered[skin[0] : skin[-1]]).sum()))
    return lid_step * widest


def _frontmost_depths(triangles: Floats64, x: float, heights: Floats64) -> Floats64:
    """Frontmost z of triangles (n, 3, 3) in the plane at x, shape (len(heights),).

    It is -inf at heights without a triangle.
    """
    across = triangles[:, :, 0]
    is_crossed = (across.min(axis=1) < x) & (across.max(axis=1) > x)
    cut, meets = cut_by(triangles[is_crossed], x)
    height = np.where(meets, cut[:, :, 1], np.inf)
    order = np.argsort(height, axis=1)[:, :, None]
    lower = np.take_along_axis(cut, order[:, :1], axis=1)
    upper = np.take_along_axis(cut, order[:, 1:2], axis=1)
    low = lower[:, :, 1]
    high = upper[:, :, 1]
    fraction = (heights - low) / np.maximum(high - low, 1e-9)
    depth = lower[:, :, 2] + fraction * (upper[:, :, 2] - lower[:, :, 2])
    inside = (fraction >= 0.0) & (fraction <= 1.0)
    reach: Floats64 = np.where(inside, depth, -np.inf).max(axis=0, initial=-np.inf)
    return reach


def inverted_count(rest: Floats64, now: Floats64, faces: Triangles) -> int:
    """Number of triangles turned by more than a right angle against the skin around them."""
    before = cross_products(rest, faces)
    after = cross_products(now, faces)
    count = 0
    compared_radius = 12.0  # mm around a triangle: the skin here gives the expected turn
    for face in np.flatnonzero((before * after).sum(axis=1) < 0.0):
        corners = faces[face]
        middle = rest[corners].mean(axis=0)
        away = np.linalg.norm(rest - middle, axis=1)
        reach = max(compared_radius, 2.0 * away[corners].max())  # beyond the triangle
        near = away < reach
        around_before = rest[near] - rest[near].mean(axis=0)
        around_now = now[near] - now[near].mean(axis=0)
        turn, _ = Rotation.align_vectors(around_now, around_before)
        expected = turn.apply(before[face])
        count += int(expected @ after[face] < 0.0)
    return count


def _worst(poses: Sequence[MeasuredPose], column: str) -> tuple[float, str]:
    """The greatest value of a column, and the name of its pose."""
    measured = [pose for pose in poses if getattr(pose, column) is not None]
    worst = max(measured, key=lambda pose: getattr(pose, column))
    return getattr(worst, column), worst.name


def report(poses: Sequence[MeasuredPose]) -> str:
    """The text to print: the number of poses, and the worst pose for each measure."""
    torn = [pose for pose in poses if pose.inverted]
    rows = [(column, *_worst(poses, column)) for column in MeasuredPose._fields[1:]]
    return "\n".join(
        [
            f"{len(poses)} poses: every row of the layers, and random mixtures of muscles;",
            f"{sum(pose.inverted for pose in torn)} triangles turned over, in {len(torn)} poses.",
            "",
            "slit      widest gap between lips that no muscle opens, from any side in front [mm]",
            "eye       greatest visible height of a shut eye, from the same sides [mm]",
            "inverted  triangles turned by more than a right angle against the skin around them",
            "lips, lids, teeth: depth of skin in them [mm]",
            "",
            *table("worst:<9|:6.2f|in:<1", rows),
        ]
    )


def targets(poses: Sequence[MeasuredPose]) -> list[Target]:
    """The targets of skin and contacts; a few triangles may be inverted, as in a wink or a yawn."""
    torn = sum(pose.inverted > 0 for pose in poses) / len(poses)
    most = LARGEST_FAULTS.items()
    most_torn = 2.0  # [% of poses]
    most_in_a_pose = 3  # triangles
    return [
        at_most("poses with a triangle turned", 100.0 * torn, most_torn, " %"),
        at_most("triangles turned in one pose", _worst(poses, "inverted")[0], most_in_a_pose),
        *(at_most(name, _worst(poses, name)[0], limit, " mm") for name, limit in most),
    ]
