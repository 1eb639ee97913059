"""The foundation of a face: the checked mesh, its size, bones, eyeballs, and names of controls.

A head may be any object with `vertices` and `faces`; optional attributes add the parts of a face.
Nothing here is compiled, so the controls of a head are available at once.

Source: Kähler et al. 2002, "Head shop": the model is fitted to a head only by landmarks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Integers32, Integers64
from ..schema import quoted
from . import checked
from .controls import GAZE_RATE, Control, Controls
from .coordinates import FaceSpace
from .landmarks import LANDMARK_COUNT, Side
from .layers import Layers, read_layers
from .lip_lid_sides import lip_side
from .muscles import sides_of
from .rig import Rig, read_rig
from .skull import (
    HEAD_CONTROLS,
    HEAD_RATE,
    Eyeball,
    Skull,
    condyles_from_landmarks,
    eyeballs_from_landmarks,
    mandible_weight_from_landmarks,
)
from .surface import SkinSurface, build_surface


class Given(NamedTuple):
    """The optional attributes of a head; an attribute that the head lacks is None."""

    landmarks: Any  # determine size, lips and lids; without them: a plain spring mesh
    rig: Any  # determines muscles, if there are landmarks
    layers: Any  # give action units, expressions, ... above the muscles (layers.py)
    jaw_axis: Any  # gives a jaw; guessed from landmarks if it is None
    mandible_weight: Any  # of each vertex; guessed from landmarks if it is None
    eyes: Any  # give gaze and contact; guessed from landmarks if None
    parts: Any  # teeth (named "teeth_..."), on which lips and cheeks rest, and a "tongue"


@dataclass(frozen=True, eq=False)
class Foundation:
    """A head before it has muscles and springs; lengths are of the standard face [mm]."""

    vertices: Floats64  # (V, 3) as the head has them [head units]
    space: FaceSpace
    rig: Rig
    surface: SkinSurface
    landmarks: Floats64  # (68, 3); zeros for a head without landmarks
    lip_side: Floats64  # (V,) of lip_lid_sides.lip_side; zeros without landmarks
    skull: Skull
    controls: tuple[Control, ...]
    layers: Layers
    landmark_indices: Integers64 | None  # (68,) vertices; None: a plain mesh
    parts: Any  # as the head has them


def controls_of(head: Any) -> Controls:
    """The controls that the simulation of a head has, at rest.

    No muscle is placed, so this takes only a moment. Raises ValueError as `create` does.
    """
    foundation = foundation_of(head)
    return Controls(foundation.controls, foundation.layers)


def foundation_of(head: Any) -> Foundation:
    """Check a head, and place its bones; raises ValueError, which names the wrong attribute."""
    vertices, faces = mesh_of("head", head)
    given = Given(*(getattr(head, name, None) for name in Given._fields))
    landmark_indices = _landmark_indices(given.landmarks, len(vertices))
    rig = read_rig(given.rig or {})
    if landmark_indices is None:
        return _plain_foundation(vertices, faces, given, rig)
    return _face_foundation(vertices, faces, given, rig, landmark_indices)


def _plain_foundation(vertices: Floats64, faces: Integers32, given: Given, rig: Rig) -> Foundation:
    """Foundation of a mesh without landmarks: its own jaw and eyes, and no muscles."""
    rig = Rig(rig.tissue, rig.jaw, rig.eyes)
    space = FaceSpace.from_bounds(vertices)
    surface = build_surface(space.to_standard(vertices), faces)
    axis = _optional("jaw_axis", given.jaw_axis, (2, 3))
    weight = _optional("mandible_weight", given.mandible_weight, (len(vertices),))
    condyles = None if axis is None else space.to_standard(axis)
    balls = () if given.eyes is None else _eyeballs(given.eyes, space)
    skull = _skull(condyles, weight, balls, rig, surface)
    controls = (*_jaw_controls(skull), *_gaze_controls(skull))
    return Foundation(
        vertices=vertices,
        space=space,
        rig=rig,
        surface=surface,
        landmarks=np.zeros((LANDMARK_COUNT, 3)),
        lip_side=np.zeros(len(vertices)),
        skull=skull,
        controls=controls,
        layers=_read_layers((), controls),  # tables of layers would have no controls to refer to
        landmark_indices=None,
        parts=given.parts,
    )


def _face_foundation(
    vertices: Floats64, faces: Integers32, given: Given, rig: Rig, landmark_indices: Integers64
) -> Foundation:
    """Foundation of a face; landmarks give the bones and eyes that the head lacks."""
    space = FaceSpace.from_landmarks(vertices[landmark_indices])
    surface = build_surface(space.to_standard(vertices), faces)
    landmarks = space.to_standard(vertices[landmark_indices])
    side = lip_side(surface, landmarks)
    axis = _optional("jaw_axis", given.jaw_axis, (2, 3))
    weight = _optional("mandible_weight", given.mandible_weight, (len(vertices),))
    if axis is None:
        condyles = condyles_from_landmarks(landmarks, rig.jaw)
    else:
        condyles = space.to_standard(axis)
    if weight is None and rig.jaw.seeds:
        weight = mandible_weight_from_landmarks(surface, landmarks, rig.jaw, side)
    if given.eyes is None:
        balls = eyeballs_from_landmarks(landmarks)
    else:
        balls = _eyeballs(given.eyes, space)
    skull = _skull(condyles, weight, balls, rig, surface)
    controls = _face_controls(rig, skull)
    tables = given.layers if rig.muscles and given.layers is not None else ()
    return Foundation(
        vertices=vertices,
        space=space,
        rig=rig,
        surface=surface,
        landmarks=landmarks,
        lip_side=side,
        skull=skull,
        controls=controls,
        layers=_read_layers(tables, controls),
        landmark_indices=landmark_indices,
        parts=given.parts,
    )


def _read_layers(tables: Any, controls: tuple[Control, ...]) -> Layers:
    """The layers above these controls."""
    return read_layers(tables, [control.name for control in controls])


def mesh_of(what: str, given: Any) -> tuple[Floats64, Integers32]:
    """Check and copy the vertices and faces of a head; `what`: its name in errors."""
    for name in ("vertices", "faces"):
        if not hasattr(given, name):
            raise ValueError(
                f"{what}: {type(given).__name__} has no attribute '{name}'; give any object with "
                "vertices (V, 3) and faces (F, 3), such as assets.load('head') or a trimesh.Trimesh"
            )
    wanted = "(V, 3) with V > 0"
    vertices = checked.numbers(f"{what}.vertices", given.vertices, (None, 3), wanted)
    # Largest coordinate [head units]: squares and cubes of lengths stay finite.
    largest_coordinate = 1e9
    if (np.abs(vertices) > largest_coordinate).any():
        raise ValueError(
            f"{what}.vertices: some exceed {largest_coordinate:g}; choose another unit of length"
        )
    if len(vertices) == 0:
        raise ValueError(f"{what}.vertices: shape was {vertices.shape}, must be {wanted}")
    wanted = "integers (F, 3)"
    faces = checked.vertex_indices(f"{what}.faces", given.faces, (None, 3), len(vertices), wanted)
    return vertices, faces.astype(np.int32)


def _landmark_indices(given: Any, vertex_count: int) -> Integers64 | None:
    """Return the checked vertex indices of the 68 landmarks, None if the head has none."""
    if given is None:
        return None
    wanted = f"{LANDMARK_COUNT} vertex indices"
    shape = (LANDMARK_COUNT,)
    return checked.vertex_indices("head.landmarks", given, shape, vertex_count, wanted)


def _optional(name: str, given: Any, shape: tuple[int, ...]) -> Floats64 | None:
    """A checked optional array of the head."""
    return None if given is None else checked.numbers(f"head.{name}", given, shape)


def _skull(
    condyles: Floats64 | None,
    weight: Floats64 | None,
    balls: tuple[Eyeball, ...],
    rig: Rig,
    surface: SkinSurface,
) -> Skull:
    """The bones; there is no jaw without condyles (2, 3) [mm] and the mandible's weight (V,)."""
    if condyles is None or weight is None:
        weight = np.zeros(surface.vertex_count)
        condyles = np.array([[-1.0, 0, 0], [1.0, 0, 0]])
    # Lips bound to one bone each would open as a rectangle; skin bound to both bones rounds the
    # mouth.
    weight = np.clip(surface.smoother(rig.jaw.softness)(weight), 0.0, 1.0)
    least_mandible = 1e-4  # share of the jaw's motion that counts as no motion
    weight[weight < least_mandible] = 0.0
    return Skull(
        condyles=condyles,
        mandible_weight=weight,
        eyeballs=balls,
        jaw=rig.jaw,
        eyes=rig.eyes,
        head=rig.head,
    )


def _eyeballs(given: Any, space: FaceSpace) -> tuple[Eyeball, ...]:
    """Return the eyeballs given by the head."""
    balls = []
    for eye in checked.several("head.eyes", given, ("name", "centre", "radius")):
        if eye.name not in ("right", "left"):
            name = quoted(eye.name)
            raise ValueError(f"head.eyes: name was {name}, allowed are 'right' and 'left'")
        centre = space.to_standard(checked.numbers("head.eyes: centre", eye.centre, (3,)))
        radius = checked.number("head.eyes: radius", eye.radius)
        if radius <= 0.0:
            raise ValueError(f"head.eyes: radius was {radius:g}, must be above 0")
        iris = getattr(eye, "iris_radius", None)
        if iris is not None:
            iris = checked.number("head.eyes: iris_radius", iris) / space.scale
        balls.append(Eyeball(Side(eye.name), centre, radius / space.scale, iris))
    return tuple(balls)


def _face_controls(rig: Rig, skull: Skull) -> tuple[Control, ...]:
    """All controls of a face: its muscles in rig order, the lips, the jaw, the gaze, the head."""
    controls = []
    for muscle in rig.muscles:
        both = [muscle.name] if muscle.halves else []
        names = [*both, *(name for name, _ in sides_of(muscle))]
        controls += [Control(name, muscle.group, action=muscle.action) for name in names]
    if skull.mandible_weight.any():  # lips that are apart at rest stay so
        controls.append(Control("lips_closed", "Lips"))
    controls += _jaw_controls(skull)
    controls += _gaze_controls(skull)
    controls += [Control(name, "Head", -1.0, 1.0, HEAD_RATE) for name in HEAD_CONTROLS]
    return tuple(controls)


def _jaw_controls(skull: Skull) -> list[Control]:
    """Controls of jaw and tongue, where there is a jaw."""
    if not skull.mandible_weight.any():
        return []
    return [
        Control("jaw_open", "Jaw"),
        Control("jaw_forward", "Jaw", -1.0),
        Control("jaw_sideways", "Jaw", -1.0),
        Control("tongue_out", "Jaw", action="tongue out over the lower lip"),
        Control("tongue_up", "Jaw", action="tip of the tongue to the upper teeth"),
    ]


def _gaze_controls(skull: Skull) -> list[Control]:
    """Controls of each eyeball."""
    return [
        Control(f"gaze_{way}_{ball.side.value}", "Gaze", -1.0, 1.0, GAZE_RATE)
        for way in ("horizontal", "vertical")
        for ball in skull.eyeballs
    ]
