"""From a mesh to everything a simulation needs: checks the head, places bones, lids, muscles and
springs.

A head may be any object with `vertices` and `faces`; optional attributes add the parts of a face.

Source: Kähler et al. 2002, "Head shop": the model is fitted to a head by landmarks alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..schema import quoted
from . import checked
from .contact import PAIR_GAP, EyeContact, Grip, LipPairs, pair_lips, watch_eyeballs
from .controls import GAZE_RATE, Control
from .coordinates import FaceSpace
from .landmarks import (
    INNER_CORNERS,
    LANDMARK_COUNT,
    LOWER_INNER,
    UPPER_INNER,
    Array,
    Side,
    mouth_line,
    polyline_distance,
    smoothstep,
)
from .layers import Layers, read_layers
from .lids import Lids, place_lids
from .lip_lid_sides import lip_side
from .muscle_forces import MuscleForces, build_muscle_forces
from .muscles import place_muscles, sides_of
from .rig import Rig, read_rig
from .skull import (
    HEAD_CONTROLS,
    HEAD_RATE,
    Eyeball,
    RigidMotion,
    Skull,
    condyles_from_landmarks,
    eyeballs_from_landmarks,
    mandible_weight_from_landmarks,
)
from .substep import LONGEST_SUBSTEP, ROUNDING
from .surface import Surface, build_surface
from .teeth import Teeth, watch_teeth
from .tissue import EdgeSprings, TissueSprings, masses_for_step
from .tongue import Tongue, place_tongue

SEAL_BROKEN_BY_JAW = 0.25  # jaw_open at which the lips no longer stick
SEAL_LOST_BY_THRUST = 0.15  # at full jaw_forward: lips slide, or the upper turns inside out
NECK_LENGTH = 45.0  # mm below the chin; the turn of the head fades evenly, or the throat turns over
MEETING_SHARE = 0.2  # share of the jaw's motion at which both lips meet over an open jaw
WHOLE_LIP_REACH = 7.0  # mm from the mouth line, up to which skin goes along in full
LIP_END_REACH = 32.0  # mm from the mouth line, from which on skin stays
LEAST_MANDIBLE = 1e-4  # share of the jaw's motion that is none
LARGEST_COORDINATE = 1e9  # [head units] of a coordinate; squares and cubes of lengths stay finite
STEP_MARGIN = 1.0 + ROUNDING  # a substep may be this much longer than LONGEST_SUBSTEP


class Given(NamedTuple):
    """The optional attributes of a head; None where the head has no such attribute."""

    landmarks: Any  # give size, lips and lids; without them the face is a plain spring mesh
    rig: Any  # gives muscles, where there are landmarks
    layers: Any  # give action units, expressions, ... above the muscles (layers.py)
    jaw_axis: Any  # gives a jaw; guessed from landmarks if it is None
    mandible_weight: Any  # of each vertex; guessed from landmarks if it is None
    eyes: Any  # give gaze and contact; guessed from landmarks if they are None
    parts: Any  # teeth (named "teeth_..."), on which lips and cheeks rest, and a "tongue"


class SkinModel(NamedTuple):
    """Point masses, springs and contacts of one face; none of it changes while it is simulated."""

    rest: Array  # (V, 3) mm, positions of the undeformed mesh
    mass: Array  # (V,)
    tissue: TissueSprings
    edges: EdgeSprings
    lips: LipPairs
    eyes: EyeContact
    teeth: Teeth


class Tick(NamedTuple):
    """Values that stay constant during one tick."""

    substeps: int
    h: float  # s, length of each
    grip: Grip  # how firmly the lips hold each other
    mandible: RigidMotion


@dataclass(frozen=True)
class FaceModel:
    """A face at rest: nothing here changes while it is simulated."""

    vertices: Array  # (V, 3) as given [head units]
    space: FaceSpace
    rig: Rig
    surface: Surface
    landmarks: Array  # (68, 3) mm; zeros without
    lip_side: Array  # (V,) of lip_lid_sides.lip_side
    skull: Skull
    muscles: MuscleForces
    lids: Lids | None
    skin: SkinModel
    tongue: Tongue | None
    turns: Array  # (V, 1) share of the head's pose: 1, fading to 0 down the neck
    passive_hold: Array  # (V,)
    closed_weight: Array  # (V,) of the mandible while the lips are kept closed over an open jaw
    controls: tuple[Control, ...]
    layers: Layers

    def grip(self, activation: Array, jaw: tuple[float, ...], closed: float) -> Grip:
        """How firmly the lips stick together; the jaw and some muscles part them.

        activation: of each muscle, shape (M,); jaw: its values open, forward, sideways; closed: how
        far the lips are kept together over an open jaw, 0..1.
        """
        if not len(self.skin.lips.lower):
            return Grip(0.0, 0.0)
        muscles = self.muscles
        strength = max(0.0, 1.0 - (1.0 - closed) * jaw[0] / SEAL_BROKEN_BY_JAW)
        if strength == 0.0:
            return Grip(0.0, 0.0)
        strength *= 1.0 - SEAL_LOST_BY_THRUST * max(jaw[1], 0.0)
        strength *= float((1.0 - activation * muscles.opens_lips).prod())
        activity = float((activation * muscles.reaches_lips).max(initial=max(map(abs, jaw))))
        return Grip.of(strength, activity)


def build_face_model(head: Any) -> FaceModel:
    """Build a face from a mesh; ValueError names the attribute of the head that is wrong."""
    vertices, faces = mesh_of("head", head)
    given = Given(*(getattr(head, name, None) for name in Given._fields))
    numbers = _landmark_numbers(given.landmarks, len(vertices))
    rig = read_rig(given.rig or {})
    if numbers is None:
        rig = Rig(rig.tissue, rig.jaw, rig.eyes)
    points = None if numbers is None else vertices[numbers]
    space = FaceSpace.from_bounds(vertices) if points is None else FaceSpace.from_landmarks(points)
    surface = build_surface(space.to_standard(vertices), faces)
    landmarks = None if points is None else space.to_standard(points)
    side = np.zeros(len(vertices)) if landmarks is None else lip_side(surface, landmarks)
    skull = _skull(given, rig, space, surface, landmarks, side)
    known = np.zeros((LANDMARK_COUNT, 3)) if landmarks is None else landmarks
    placed = place_muscles(rig, surface, known, side)
    seal = rig.tissue.lip_seal * rig.tissue.stiffness_scale
    lips = pair_lips(surface, known, side, seal)
    muscles = build_muscle_forces(
        placed, rig, surface, skull.mandible_weight, lips.members, known, side
    )
    controls = _controls(rig, skull, landmarks is not None)
    lids = None
    if landmarks is not None and skull.eyeballs:
        names = [control.name for control in controls]
        lids = place_lids(rig, surface, landmarks, skull.eyeballs, names)
    corners = np.zeros((0, 3)) if landmarks is None else landmarks[list(INNER_CORNERS)]
    springs = TissueSprings.under(surface, rig.tissue)
    edges = EdgeSprings.along(surface, rig.tissue, corners)
    passive, greatest = _holds(muscles, lids, surface.vertex_count)
    skin = SkinModel(
        rest=surface.positions,
        mass=_masses(surface, springs, edges, greatest),
        tissue=springs,
        edges=edges,
        lips=lips,
        eyes=watch_eyeballs(surface, skull.eyeballs),
        teeth=watch_teeth(given.parts, surface, space),
    )
    return FaceModel(
        vertices=vertices, space=space, rig=rig, surface=surface, landmarks=known, lip_side=side,
        skull=skull, muscles=muscles, lids=lids, skin=skin,
        tongue=place_tongue(given.parts, space, numbers),
        passive_hold=passive, turns=_turning_share(surface, landmarks),
        closed_weight=_closed_weight(surface, landmarks, skull.mandible_weight),
        controls=controls, layers=_layers(given.layers, rig, controls),
    )  # fmt: skip


def _masses(surface: Surface, springs: TissueSprings, edges: EdgeSprings, greatest: Array) -> Array:
    """Mass of each vertex; `greatest`: stiffness of fully active muscles there, shape (V,)."""
    bound = edges.row_bound(surface.vertex_count)
    bound += np.maximum(springs.tangential, springs.normal) + greatest
    return masses_for_step(surface.areas, bound, LONGEST_SUBSTEP * STEP_MARGIN)


def mesh_of(what: str, given: Any) -> tuple[Array, npt.NDArray[np.int32]]:
    """Checked copies of the vertices and faces of a head; `what`: its name in errors."""
    for name in ("vertices", "faces"):
        if not hasattr(given, name):
            raise ValueError(
                f"{what}: {type(given).__name__} has no attribute '{name}'; give any object with "
                "vertices (V, 3) and faces (F, 3), such as assets.load('head') or a trimesh.Trimesh"
            )
    wanted = "(V, 3) with V > 0"
    vertices = checked.numbers(f"{what}.vertices", given.vertices, (None, 3), wanted)
    if (np.abs(vertices) > LARGEST_COORDINATE).any():
        raise ValueError(
            f"{what}.vertices: some are beyond {LARGEST_COORDINATE:g}; take another unit of length"
        )
    if len(vertices) == 0:
        raise ValueError(f"{what}.vertices: shape was {vertices.shape}, must be {wanted}")
    wanted = "integers (F, 3)"
    faces = checked.vertex_numbers(f"{what}.faces", given.faces, (None, 3), len(vertices), wanted)
    return vertices, faces.astype(np.int32)


def _landmark_numbers(given: Any, vertex_count: int) -> npt.NDArray[np.int64] | None:
    """Checked vertex numbers of the 68 landmarks, None if the head has none."""
    if given is None:
        return None
    wanted = f"{LANDMARK_COUNT} vertex numbers"
    shape = (LANDMARK_COUNT,)
    return checked.vertex_numbers("head.landmarks", given, shape, vertex_count, wanted)


def _optional(name: str, given: Any, shape: tuple[int, ...]) -> Array | None:
    """A checked optional array of the head."""
    return None if given is None else checked.numbers(f"head.{name}", given, shape)


def _skull(
    head: Given, rig: Rig, space: FaceSpace, surface: Surface, landmarks: Array | None, side: Array
) -> Skull:
    """Bones from the head's attributes, else from landmarks; without either there is no jaw."""
    axis = _optional("jaw_axis", head.jaw_axis, (2, 3))
    weight = _optional("mandible_weight", head.mandible_weight, (surface.vertex_count,))
    condyles = None if axis is None else space.to_standard(axis)
    if landmarks is not None:
        if condyles is None:
            condyles = condyles_from_landmarks(landmarks, rig.jaw)
        if weight is None and rig.jaw.seeds:
            weight = mandible_weight_from_landmarks(surface, landmarks, rig.jaw, side)
    if condyles is None or weight is None:
        weight = np.zeros(surface.vertex_count)
        condyles = np.array([[-1.0, 0, 0], [1.0, 0, 0]])
    # Lips clamped to one bone open like a letter box; skin between the bones rounds the mouth.
    weight = np.clip(surface.smoothed(weight, rig.jaw.softness), 0.0, 1.0)
    weight[weight < LEAST_MANDIBLE] = 0.0
    balls = _eyeballs(head.eyes, space, landmarks)
    return Skull(condyles, weight, balls, rig.jaw, rig.eyes, rig.head)


def _eyeballs(given: Any, space: FaceSpace, landmarks: Array | None) -> tuple[Eyeball, ...]:
    """The head's eyes, or guessed ones where it has landmarks; none otherwise."""
    if given is None:
        return () if landmarks is None else eyeballs_from_landmarks(landmarks)
    balls = []
    for eye in checked.several("head.eyes", given, ("name", "centre", "radius")):
        if eye.name not in ("right", "left"):
            name = quoted(eye.name)
            raise ValueError(f"head.eyes: name was {name}, allowed are 'right' and 'left'")
        centre = space.to_standard(checked.numbers("head.eyes: centre", eye.centre, (3,)))
        radius = checked.number("head.eyes: radius", eye.radius)
        if radius <= 0.0:
            raise ValueError(f"head.eyes: radius was {radius:g}, must be above 0")
        balls.append(Eyeball(Side(eye.name), centre, radius / space.scale))
    return tuple(balls)


def _holds(muscles: MuscleForces, lids: Lids | None, count: int) -> tuple[Array, Array]:
    """Stiffness of relaxed and of fully active muscles, lids included, per vertex."""
    greatest = muscles.hold_of(np.ones_like(muscles.skin.passive), count)
    passive = muscles.hold_of(muscles.skin.passive, count)
    if lids is not None:
        for hold in (passive, greatest):
            np.add.at(hold, lids.vertices.vertex, lids.hold)
        moved = lids.vertices.fold_hold + lids.vertices.shut_hold
        np.add.at(greatest, lids.vertices.vertex, moved)
    return passive, greatest


def _turning_share(surface: Surface, landmarks: Array | None) -> Array:
    """How far skin follows the pose of the head, shape (V, 1): the foot of the neck stays."""
    if landmarks is None:
        return np.ones((surface.vertex_count, 1))
    below = landmarks[8, 1] - surface.positions[:, 1]
    share: Array = np.clip(1.0 - below / NECK_LENGTH, 0.0, 1.0)[:, None]
    return share


def _closed_weight(surface: Surface, landmarks: Array | None, weight: Array) -> Array:
    """The mandible's weight where lips stay as at rest although the jaw is open, shape (V,)."""
    if landmarks is None:
        return weight.copy()
    distance = polyline_distance(surface.positions, mouth_line(landmarks))
    upper, lower = (landmarks[list(lip)] for lip in (UPPER_INNER, LOWER_INNER))
    if np.linalg.norm(upper - lower, axis=1).max() > PAIR_GAP:  # open at rest
        lips = [polyline_distance(surface.positions, lip) for lip in (upper, lower)]
        distance = np.minimum(*lips)
    reach = (LIP_END_REACH - distance) / (LIP_END_REACH - WHOLE_LIP_REACH)
    return weight + smoothstep(reach) * (MEETING_SHARE - weight)


def _controls(rig: Rig, skull: Skull, is_face: bool) -> tuple[Control, ...]:
    """All controls of a face: its muscles in rig order, the lips, the jaw, the gaze, the head."""
    controls = []
    for muscle in rig.muscles:
        both = [muscle.name] if muscle.halves else []
        names = [*both, *(name for name, _ in sides_of(muscle))]
        controls += [Control(name, muscle.group, action=muscle.action) for name in names]
    if skull.mandible_weight.any() and is_face:  # lips that are apart at rest stay so far apart
        controls.append(Control("lips_closed", "Lips"))
    if skull.mandible_weight.any():
        controls.append(Control("jaw_open", "Jaw"))
        controls += [Control(name, "Jaw", -1.0) for name in ("jaw_forward", "jaw_sideways")]
        controls.append(Control("tongue_out", "Jaw", action="tongue out over the lower lip"))
        controls.append(Control("tongue_up", "Jaw", action="tip of the tongue to the upper teeth"))
    if skull.eyeballs:
        for way in ("horizontal", "vertical"):
            for ball in skull.eyeballs:
                name = f"gaze_{way}_{ball.side.value}"
                controls.append(Control(name, "Gaze", -1.0, 1.0, GAZE_RATE))
    if is_face:
        for name in HEAD_CONTROLS:
            controls.append(Control(name, "Head", -1.0, 1.0, HEAD_RATE))
    return tuple(controls)


def _layers(given: Any, rig: Rig, controls: tuple[Control, ...]) -> Layers:
    """The head's layers; a face without muscles has nothing that its tables could speak of."""
    tables = given if rig.muscles and given is not None else ()
    return read_layers(tables, [control.name for control in controls])
