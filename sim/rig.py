"""The muscle rig: the tables of a rig file, as frozen dataclasses with a range for every key.

A rig names tissue, jaw, eyes and muscles in terms of the 68 landmarks (see landmarks.py), in
millimetres of a head whose outer eye corners are 89.2 mm apart; `sim.create` scales it to the
head at hand. Muscles are defined for the subject's left side and mirrored.

    format = 1
    [tissue]                 membrane, tissue springs, damping: class Tissue
    [jaw]                    hinge, glide, seeds of the mandible weight: class Jaw
    [eyes]                   gaze, lids resting on the eyeballs: class Eyes
    [head]                   angles and axis of the head's turns: class Head
    [muscle.<name>]          kind = "linear" | "ring" | "lid", then the keys of class LinearMuscle,
                             RingMuscle or LidMuscle; <name> in full anatomical words, without side
    [[muscle.<name>.fibre]]  one table per fibre of a linear muscle: class Fibre

A point is a table {landmarks = {45 = 0.6, 14 = 0.4}, offset = [-4.5, -17.6, -5.6]}: a mix of
landmarks (or `landmark = 54`) and an offset lateral, up, forward. Every key has a range; a value
outside raises ValueError with the muscle, the key and the allowed range.

Source: Kähler et al. 2001 (fibres, linear muscles and sphincters), 2002 (landmarks carry the
muscles to another head).
Differs from it: lids are a separate kind that turns over the eyeball, where the papers use a
sphincter.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

from ..schema import (
    Flag,
    Hidden,
    Kinds,
    MadeFrom,
    OneOf,
    Record,
    Within,
    called,
    question,
    read_once,
)
from .landmarks import LANDMARK_COUNT, LandmarkPoint

LID_ACTIONS = ("upper_close", "lower_raise", "upper_raise")  # actions of lid muscles

MOUTH_POINT = LandmarkPoint(((62, 0.5), (66, 0.5)))  # where the lips meet

TwoNumbers = tuple[float, float]
Triple = tuple[float, float, float]


Mix = tuple[tuple[int, float], ...]  # numbers of landmarks, and the weight of each


def _mix_of_landmarks(weights: dict[str, float]) -> Mix:
    """Pairs of a table with rows "landmark number = weight"."""
    if not weights:
        raise ValueError("is empty, must be a table landmark number = weight")
    return tuple((int(number), weight) for number, weight in weights.items())


Landmark = Annotated[
    str, OneOf(tuple(map(str, range(LANDMARK_COUNT))), f"a landmark, 0 to {LANDMARK_COUNT - 1}")
]
Weights = Annotated[
    Mix, MadeFrom(dict[Landmark, Annotated[float, Within(-5.0, 5.0)]], _mix_of_landmarks)
]


@dataclass(frozen=True)
class _PointTable(Record):
    """{landmark = 54} or {landmarks = {45 = 0.6, 14 = 0.4}}, with or without an offset."""

    landmark: Annotated[int, Within(0, LANDMARK_COUNT - 1)] | None = None
    landmarks: Weights | None = None
    offset: Annotated[Triple, Within(-200.0, 200.0)] = (0.0, 0.0, 0.0)

    def point(self) -> LandmarkPoint:
        """Point of this table; raises ValueError for none, two, or weights that do not sum to 1."""
        if (self.landmark is None) == (self.landmarks is None):
            raise ValueError("give exactly one of 'landmark' and 'landmarks'")
        mix = self.landmarks or ((self.landmark or 0, 1.0),)
        total = sum(weight for _, weight in mix)
        if abs(total - 1.0) > 1e-6:
            raise ValueError(f"the landmark weights add up to {total:g}; they must add up to 1")
        return LandmarkPoint(mix, self.offset)


RigPoint = Annotated[LandmarkPoint, MadeFrom(_PointTable, _PointTable.point)]


@dataclass(frozen=True)
class Tissue(Record):
    """Uniform skin and soft tissue; stiffness is per skin area, times `stiffness_scale`."""

    tangential: Annotated[float, Within(0.0, 100.0)] = 0.19  # resistance to sliding over the bone
    normal: Annotated[float, Within(0.0, 1000.0)] = 7.6  # resistance to sinking in or lifting off
    membrane: Annotated[float, Within(0.0, 1e4)] = 100.0  # mm2, edge springs (Van Gelder)
    shear: Annotated[float, Within(0.0, 100.0)] = 4.0  # x membrane: neighbours move alike
    # slope of an edge spring beyond the limit
    stiffening: Annotated[float, Within(1.0, 20.0)] = 4.0
    # strain where it starts (biphasic)
    stiffening_strain: Annotated[float, Within(0.0, 2.0)] = 0.25
    septum: Annotated[float, Within(0.0, 1000.0)] = 0.0  # resistance on the nose's cartilage
    modiolus: Annotated[float, Within(0.0, 50.0)] = 0.0  # how much firmer skin is at mouth corners
    modiolus_shear: Annotated[float, Within(0.0, 50.0)] = 0.0  # the same, against turning
    passive: Annotated[float, Within(0.0, 1.0)] = 0.2  # share of a muscle's stiffness when relaxed
    lip_seal: Annotated[float, Within(0.0, 1000.0)] = 40.0  # springs that hold closed lips together
    drive_power: Annotated[float, Within(0.3, 1.5)] = 1.0  # pull = activation raised to this power
    stiffness_scale: Annotated[float, Within(1.0, 1e5)] = 600.0  # 1/s2
    damping: Annotated[float, Within(0.0, 1000.0)] = 8.0  # 1/s, everywhere
    # of critical, for tissue and muscle springs
    damping_ratio: Annotated[float, Within(0.0, 3.0)] = 0.9


@dataclass(frozen=True)
class Jaw(Record):
    """The mandible: it turns about the condyles and glides with them."""

    opening_deg: Annotated[float, Within(0.0, 45.0)] = 22.0  # hinge angle at jaw_open = 1
    opening_glide: Annotated[Triple, Within(-30.0, 30.0)] = (0.0, -4.0, 0.0)
    forward_glide: Annotated[Triple, Within(-30.0, 30.0)] = (0.0, -2.0, 8.0)
    sideways_glide: Annotated[Triple, Within(-30.0, 30.0)] = (1.0, 0.0, 0.0)
    sideways_deg: Annotated[float, Within(0.0, 20.0)] = 6.5  # yaw about the condyle of that side
    condyle: Annotated[Triple, Within(-100.0, 100.0)] = (0.0, -20.0, -20.0)
    softness: Annotated[float, Within(0.0, 1000.0)] = 60.0  # mm2, smooths the mandible weight
    seeds: Weights = ()


@dataclass(frozen=True)
class Eyes(Record):
    """Eyeballs, and the contact of lids with them."""

    gaze_deg: Annotated[float, Within(0.0, 60.0)] = 30.0  # eye rotation at gaze = 1
    # share of the vertical gaze angle: up, down
    upper_lid_follows: Annotated[TwoNumbers, Within(0.0, 1.0)] = (0.55, 0.8)
    lower_lid_follows: Annotated[float, Within(0.0, 1.0)] = 0.3
    lid_reach: Annotated[float, Within(2.0, 30.0)] = 8.0  # mm from the margin to where the lid ends
    lid_plateau: Annotated[float, Within(0.0, 20.0)] = 2.0  # mm from the margin that move as one
    # stiffness of the tarsal plate on the eyeball
    lid_stiffness: Annotated[float, Within(0.0, 1000.0)] = 120.0
    # share of the way that the lower lid comes up
    blink_meeting: Annotated[float, Within(0.0, 0.5)] = 0.12
    blink_slide: Annotated[TwoNumbers, Within(-5.0, 5.0)] = (0.0, 0.0)  # mm to the nose
    raise_slide: Annotated[float, Within(-10.0, 10.0)] = 0.0  # the same, for each rad of raising
    lids_follow_sideways: Annotated[float, Within(0.0, 1.0)] = 0.0  # share of the horizontal gaze
    # mm from the upper margin: nearer skin moves fully with the lid
    fold_plateau: Annotated[float, Within(0.0, 30.0)] = 2.0
    # mm from the upper margin: farther skin does not move with the lid
    fold_reach: Annotated[float, Within(2.0, 40.0)] = 8.0
    # stiffness of the skin beyond the lid, while the lid moves
    fold_stiffness: Annotated[float, Within(0.0, 1000.0)] = 0.0


@dataclass(frozen=True)
class HeadJoint(Record):
    """The joint between skull and spine, about which the head turns as a whole."""

    pitch_deg: Annotated[float, Within(0.0, 90.0)] = 30.0  # at head_pitch = 1, up
    yaw_deg: Annotated[float, Within(0.0, 90.0)] = 45.0  # at head_yaw = 1, to the subject's left
    roll_deg: Annotated[float, Within(0.0, 90.0)] = 30.0  # at head_roll = 1, to the left shoulder
    # mm from the middle between the condyles
    joint: Annotated[Triple, Within(-200.0, 200.0)] = (0.0, -15.0, -20.0)


@dataclass(frozen=True)
class Fibre(Record):
    """One fibre from its origin (on bone, fixed) to its insertion (in the skin, moving)."""

    origin: RigPoint
    insertion: RigPoint
    weight: Annotated[float, Within(0.0, 3.0)] = 1.0  # how firmly skin around it is attached
    gain: Annotated[float, Within(0.0, 6.0)] = 1.0  # of its pull relative to the other fibres
    width_factor: Annotated[float, Within(0.1, 4.0)] = 1.0  # x the muscle's width
    convergence: Annotated[float, Within(-2.0, 2.0)] = 0.0  # skin drawn towards the fibre line
    lift: Annotated[float, Within(-20.0, 20.0)] = 0.0  # mm outward all along; below 0 a crease


@dataclass(frozen=True)
class Muscle(Record):
    """The keys of every kind of muscle."""

    name: Hidden[str] = field(default="", kw_only=True)  # the key of its table
    action: str  # its effect on the face, with the action units
    group: str  # title under which a panel lists it
    stiffness: Annotated[float, Within(0.0, 500.0)] = 30.0  # of its hold on the skin, per area
    pair: Flag = True  # one on each side, or one in the middle
    halves: Flag = False  # a pair that also has a control for both
    crosses: Flag = False  # a pair whose muscles also reach the other side
    drive: Annotated[float, Within(0.5, 2.0)] = 1.0  # x drive_power of the tissue
    tone: Flag = True  # also holds the skin when relaxed
    bone: Annotated[str, OneOf(("cranium", "mandible"))] = "cranium"  # where the origin is fixed
    gate: Annotated[str, OneOf(("none", "upper_lip", "lower_lip"))] = (
        "none"  # which lip it may move
    )
    opens_lips: Annotated[float, Within(0.0, 1.0)] = 0.0  # share by which it breaks the lip seal
    slides_lips: Annotated[float, Within(0.0, 1.0)] = 0.0  # the same, but no gap opens
    lies_on: tuple[str, ...] = ()  # muscles beneath, which carry it


@dataclass(frozen=True)
class LinearMuscle(Muscle):
    """Fibres that contract along their own arc and drag the skin around them."""

    width: Annotated[float, Within(1.0, 60.0)] = 10.0  # mm across the fibre
    beyond: Annotated[float, Within(1.0, 60.0)] = 10.0  # mm past the insertion
    # share of its length lost at full activation
    contraction: Annotated[float, Within(0.0, 0.95)] = 0.3
    fixed_at: Annotated[float, Within(0.0, 0.5)] = 0.0  # place that stays fixed: 0 for a bone
    wrap: Annotated[float, Within(0.0, 1.5)] = 0.7  # 0 straight .. 1 bent to follow the skin
    bulge: Annotated[float, Within(0.0, 20.0)] = 0.0  # mm of thickening at full activation
    bulge_at: Annotated[float, Within(0.0, 1.0)] = 0.5  # place of the bulge along the fibre
    fibres: Annotated[tuple[Fibre, ...], called("fibre")] = ()


@dataclass(frozen=True)
class RingMuscle(Muscle):
    """A sphincter or a part of one: skin on an elliptic ring moves to a centre, and outward."""

    centre: RigPoint = MOUTH_POINT
    shape: RigPoint | None = None  # middle of the ellipse; None: `centre`
    radii: Annotated[Triple, Within(1.0, 100.0)] = (20.0, 10.0, 10.0)
    edge: Annotated[TwoNumbers, Within(0.05, 10.0)] = (0.7, 1.0)  # falloff outside, inside
    contraction: Annotated[Triple, Within(-2.0, 2.0)] = (0.2, 0.2, 0.2)
    push: Annotated[Triple, Within(-30.0, 30.0)] = (0.0, 0.0, 0.0)
    bulge: Annotated[float, Within(0.0, 40.0)] = 0.0  # mm outward along the skin's normal
    # mm up for the upper, down for the lower lip; away from an opening
    flare: Annotated[float, Within(-30.0, 30.0)] = 0.0
    # about the centre: skin above it goes forward, skin in front of it to the side
    turn_deg: Annotated[TwoNumbers, Within(-90.0, 90.0)] = (0.0, 0.0)
    # of a round opening between the lips, as a share of the mouth's width; 0: none
    opening_width: Annotated[float, Within(0.0, 3.0)] = 0.0
    opening_height: Annotated[float, Within(0.0, 30.0)] = 0.0  # mm, of each lip's half of it
    arc_deg: Annotated[Triple, Within(-360.0, 360.0)] = (0.0, 180.0, 1.0)


@dataclass(frozen=True)
class LidMuscle(Muscle):
    """A muscle that turns an eyelid over the eyeball."""

    lid: Annotated[str, OneOf(LID_ACTIONS)] = "upper_close"
    travel: Annotated[float, Within(0.0, 2.0)] = 1.0  # x the lid aperture at full activation


MUSCLE_KINDS: dict[str, type[Muscle]] = {
    "linear": LinearMuscle,
    "ring": RingMuscle,
    "lid": LidMuscle,
}


def _muscles(tables: dict[str, Muscle]) -> tuple[Muscle, ...]:
    """Muscles with their names; raises ValueError for an impossible muscle or `lies_on`."""
    for name, muscle in tables.items():
        if not name.isidentifier() or name != name.lower():
            raise ValueError(f"'{name}': a name is lower case letters, digits and underscores")
        if name.endswith(("_left", "_right")):
            raise ValueError(f"'{name}': the side is added by itself, omit '_left' and '_right'")
        if isinstance(muscle, LinearMuscle) and not muscle.fibres:
            raise ValueError(
                f"'{name}': a linear muscle needs at least one [[muscle.{name}.fibre]]"
            )
    muscles = {name: replace(muscle, name=name) for name, muscle in tables.items()}
    for muscle in muscles.values():
        _check_carriers(muscle, muscles)
    return tuple(muscles.values())


def _check_carriers(muscle: Muscle, muscles: Mapping[str, Muscle]) -> None:
    """Refuse a muscle on a missing muscle, on a lid, or (through other muscles) on itself."""
    where = f"'{muscle.name}', 'lies_on'"
    if muscle.lies_on and isinstance(muscle, LidMuscle):
        raise ValueError(f"{where}: a lid lies on the eyeball; omit the key")
    for name in muscle.lies_on:
        if name not in muscles:
            raise ValueError(f"{where}: there is no muscle '{name}'{question(name, muscles)}")
        if isinstance(muscles[name], LidMuscle):
            raise ValueError(f"{where}: '{name}' is a lid, which carries nothing; remove it")
    _refuse_circle(muscles, (muscle.name,))


def _refuse_circle(muscles: Mapping[str, Muscle], path: tuple[str, ...]) -> None:
    """Go down from the last muscle of `path`; raise ValueError on a return to its first muscle."""
    for name in muscles[path[-1]].lies_on:
        if name == path[0]:
            circle = " on ".join((*path, name))
            raise ValueError(f"'{name}', 'lies_on': {circle} is a circle; remove one")
        if name in muscles and name not in path:
            _refuse_circle(muscles, (*path, name))


@dataclass(frozen=True)
class Rig(Record):
    """A whole rig; `Rig()` is plain tissue with a jaw and no muscles."""

    tissue: Tissue = Tissue()
    jaw: Jaw = Jaw()
    eyes: Eyes = Eyes()
    head: HeadJoint = HeadJoint()
    muscles: Annotated[
        tuple[Muscle, ...],
        called("muscle"),
        MadeFrom(dict[str, Annotated[Muscle, Kinds(MUSCLE_KINDS)]], _muscles),
    ] = ()
    format: Literal[1] = 1


def read_rig(document: Mapping[str, Any]) -> Rig:
    """Read a rig from the parsed rig file; raises ValueError with the wrong muscle and key."""
    return read_once(Rig, document, "rig")
