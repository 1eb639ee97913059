"""The muscle rig: what a rig file may say, as frozen dataclasses with a range for every key.

A rig names tissue, jaw, eyes and muscles in terms of the 68 landmarks (see landmarks.py), in
millimetres of a head whose outer eye corners are 89.2 mm apart; `sim.create` scales it to the
head at hand. Muscles are written for the subject's left side and mirrored.

    format = 1
    [tissue]                 membrane, tissue springs, damping: class Tissue
    [jaw]                    hinge, glide, seeds of the mandible weight: class Jaw
    [eyes]                   gaze, lids resting on the eyeballs: class Eyes
    [head]                   how far and about what the head turns: class Head
    [muscle.<name>]          kind = "linear" | "ring" | "lid", then the keys of class LinearMuscle,
                             RingMuscle or LidMuscle; <name> in full anatomical words, without side
    [[muscle.<name>.fibre]]  one table per fibre of a linear muscle: class Fibre

A point is a table {landmarks = {45 = 0.6, 14 = 0.4}, offset = [-4.5, -17.6, -5.6]}: a mix of
landmarks (or `landmark = 54`) and an offset lateral, up, forward. Every key has a range; what is
outside is refused with the muscle, the key and the allowed range.

Source: Kähler et al. 2001 (fibres, linear muscles and sphincters), 2002 (landmarks carry the
muscles to another head).
Differs from it: lids are a kind of their own, turning over the eyeball, where the papers use a
sphincter.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .landmarks import LandmarkPoint

FORMAT = 1
BONES = ("cranium", "mandible")
GATES = ("none", "upper_lip", "lower_lip")
LIDS = ("upper_close", "lower_raise", "upper_raise")  # what a lid muscle does

MOUTH = LandmarkPoint(((62, 0.5), (66, 0.5)))  # where the lips meet


def _number(low: float, high: float, *, default: float | None = None) -> Any:
    """A number between `low` and `high`; required when it has no default."""
    rule = {"rule": "number", "low": low, "high": high}
    return field(metadata=rule) if default is None else field(default=default, metadata=rule)


def _vector(size: int, low: float, high: float, *, default: tuple[float, ...] | None = None) -> Any:
    """A list of `size` numbers between `low` and `high`."""
    rule = {"rule": "vector", "size": size, "low": low, "high": high}
    return field(metadata=rule) if default is None else field(default=default, metadata=rule)


def _choice(allowed: tuple[str, ...], *, default: str | None = None) -> Any:
    """One of the words in `allowed`."""
    rule = {"rule": "choice", "allowed": allowed}
    return field(metadata=rule) if default is None else field(default=default, metadata=rule)


TEXT, BOOLEAN, POINT = {"rule": "text"}, {"rule": "boolean"}, {"rule": "point"}
SEEDS, FIBRES, NAMES = {"rule": "seeds"}, {"rule": "fibres"}, {"rule": "names"}


@dataclass(frozen=True)
class Tissue:
    """Uniform skin and soft tissue; stiffness is per skin area and relative to the scale."""

    tangential: float = _number(0.0, 100.0, default=0.19)  # resistance to sliding over the bone
    normal: float = _number(0.0, 1000.0, default=7.6)  # resistance to sinking in or lifting off
    membrane: float = _number(0.0, 1e4, default=100.0)  # mm2, edge springs (Van Gelder)
    shear: float = _number(0.0, 100.0, default=4.0)  # x membrane: neighbours move alike
    stiffening: float = _number(1.0, 20.0, default=4.0)  # slope of an edge spring beyond the limit
    stiffening_strain: float = _number(0.0, 2.0, default=0.25)  # strain where it starts (biphasic)
    modiolus: float = _number(0.0, 50.0, default=0.0)  # how much firmer skin is at mouth corners
    modiolus_shear: float = _number(0.0, 50.0, default=0.0)  # the same, against turning
    passive: float = _number(0.0, 1.0, default=0.2)  # share of a muscle's stiffness when relaxed
    heaviness: float = _number(0.0, 1.0, default=0.1)  # share of weight and inertia that is free
    lip_seal: float = _number(0.0, 1000.0, default=40.0)  # springs that hold closed lips together
    drive_power: float = _number(0.3, 1.5, default=1.0)  # pull = activation to this power
    stiffness_scale: float = _number(1.0, 1e5, default=600.0)  # 1/s2
    damping: float = _number(0.0, 1000.0, default=8.0)  # 1/s, everywhere
    damping_ratio: float = _number(
        0.0, 3.0, default=0.9
    )  # of critical, for tissue and muscle springs


@dataclass(frozen=True)
class Jaw:
    """The mandible: it turns about the condyles and glides with them."""

    opening_deg: float = _number(0.0, 45.0, default=22.0)  # hinge angle at jaw_open = 1
    opening_glide: tuple[float, float, float] = _vector(3, -30.0, 30.0, default=(0.0, -4.0, 0.0))
    forward_glide: tuple[float, float, float] = _vector(3, -30.0, 30.0, default=(0.0, -2.0, 8.0))
    sideways_glide: tuple[float, float, float] = _vector(3, -30.0, 30.0, default=(1.0, 0.0, 0.0))
    sideways_deg: float = _number(0.0, 20.0, default=6.5)  # yaw about the condyle of that side
    condyle: tuple[float, float, float] = _vector(3, -100.0, 100.0, default=(0.0, -20.0, -20.0))
    softness: float = _number(0.0, 1000.0, default=60.0)  # mm2, smooths the mandible weight
    seeds: tuple[tuple[int, float], ...] = field(default=(), metadata=SEEDS)


@dataclass(frozen=True)
class Eyes:
    """Eyeballs, and how the lids ride on them."""

    gaze_deg: float = _number(0.0, 60.0, default=30.0)  # eye rotation at gaze = 1
    upper_lid_follows: tuple[float, float] = _vector(
        2, 0.0, 1.0, default=(0.55, 0.8)
    )  # share of the vertical gaze angle: up, down
    lower_lid_follows: float = _number(0.0, 1.0, default=0.3)
    lid_reach: float = _number(2.0, 30.0, default=8.0)  # mm from the margin to where the lid ends
    lid_plateau: float = _number(0.0, 20.0, default=2.0)  # mm from the margin that move as one
    lid_stiffness: float = _number(0.0, 1000.0, default=120.0)  # of the tarsal plate on the eyeball
    blink_meeting: float = _number(
        0.0, 0.5, default=0.12
    )  # share of the way the lower lid comes up
    blink_slide: tuple[float, float] = _vector(2, -5.0, 5.0, default=(0.0, 0.0))  # mm to the nose
    raise_slide: float = _number(-10.0, 10.0, default=0.0)  # the same, for each rad of raising
    lids_follow_sideways: float = _number(0.0, 1.0, default=0.0)  # share of the horizontal gaze
    fold_plateau: float = _number(0.0, 30.0, default=2.0)  # mm from the upper margin: the skin that
    fold_reach: float = _number(2.0, 40.0, default=8.0)  # goes with it in full and at all, if open
    fold_stiffness: float = _number(0.0, 1000.0, default=0.0)  # of what is not lid, while it moves


@dataclass(frozen=True)
class Head:
    """The head turns as a whole about the joint between skull and spine."""

    pitch_deg: float = _number(0.0, 90.0, default=30.0)  # at head_pitch = 1, up
    yaw_deg: float = _number(0.0, 90.0, default=45.0)  # at head_yaw = 1, to the subject's left
    roll_deg: float = _number(0.0, 90.0, default=30.0)  # at head_roll = 1, to the left shoulder
    joint: tuple[float, float, float] = _vector(
        3, -200.0, 200.0, default=(0.0, -15.0, -20.0)
    )  # mm from the middle between the condyles


@dataclass(frozen=True)
class Fibre:
    """One fibre from its origin (on bone, fixed) to its insertion (in the skin, moving)."""

    origin: LandmarkPoint = field(metadata=POINT)
    insertion: LandmarkPoint = field(metadata=POINT)
    weight: float = _number(0.0, 3.0, default=1.0)  # how firmly skin around it is attached
    gain: float = _number(0.0, 6.0, default=1.0)  # of its pull against the other fibres
    width_factor: float = _number(0.1, 4.0, default=1.0)  # x the muscle's width
    convergence: float = _number(-2.0, 2.0, default=0.0)  # skin drawn towards the fibre line
    lift: float = _number(-20.0, 20.0, default=0.0)  # mm outward all along; below 0 a crease


@dataclass(frozen=True)
class Muscle:
    """What all kinds of muscle share."""

    name: str
    action: str = field(metadata=TEXT)  # what it does to the face, with the action units
    group: str = field(metadata=TEXT)  # title under which a panel lists it
    stiffness: float = _number(0.0, 500.0, default=30.0)  # of its hold on the skin, per area
    pair: bool = field(default=True, metadata=BOOLEAN)  # one on each side, or one in the middle
    halves: bool = field(default=False, metadata=BOOLEAN)  # a pair with a control for both, too
    crosses: bool = field(default=False, metadata=BOOLEAN)  # a pair, each also on the other side
    drive: float = _number(0.5, 2.0, default=1.0)  # x drive_power of the tissue
    tone: bool = field(default=True, metadata=BOOLEAN)  # holds the skin when relaxed, too
    bone: str = _choice(BONES, default="cranium")  # where the origin is fixed
    gate: str = _choice(GATES, default="none")  # which lip it may move
    opens_lips: float = _number(0.0, 1.0, default=0.0)  # how far it breaks the lip seal
    lies_on: tuple[str, ...] = field(default=(), metadata=NAMES)  # muscles that carry it


@dataclass(frozen=True)
class LinearMuscle(Muscle):
    """Fibres that contract along their own arc and drag the skin around them."""

    width: float = _number(1.0, 60.0, default=10.0)  # mm across the fibre
    beyond: float = _number(1.0, 60.0, default=10.0)  # mm past the insertion
    contraction: float = _number(
        0.0, 0.95, default=0.3
    )  # share of its length lost at full activation
    fixed_at: float = _number(0.0, 0.5, default=0.0)  # where it stays: 0 bone, more slides there
    wrap: float = _number(0.0, 1.5, default=0.7)  # 0 straight .. 1 bent to follow the skin
    bulge: float = _number(0.0, 20.0, default=0.0)  # mm of thickening at full activation
    bulge_at: float = _number(0.0, 1.0, default=0.5)  # where along the fibre
    fibres: tuple[Fibre, ...] = field(default=(), metadata=FIBRES)


@dataclass(frozen=True)
class RingMuscle(Muscle):
    """A sphincter or a part of one: skin on an elliptic ring is drawn to a centre and flared."""

    centre: LandmarkPoint = field(default=MOUTH, metadata=POINT)
    shape: LandmarkPoint | None = field(default=None, metadata=POINT)  # middle of the ring
    radii: tuple[float, float, float] = _vector(3, 1.0, 100.0, default=(20.0, 10.0, 10.0))
    edge: tuple[float, float] = _vector(
        2, 0.05, 10.0, default=(0.7, 1.0)
    )  # falloff outside, inside
    contraction: tuple[float, float, float] = _vector(3, -2.0, 2.0, default=(0.2, 0.2, 0.2))
    push: tuple[float, float, float] = _vector(3, -30.0, 30.0, default=(0.0, 0.0, 0.0))
    bulge: float = _number(0.0, 40.0, default=0.0)  # mm outward along the skin's normal
    flare: float = _number(-30.0, 30.0, default=0.0)  # mm up for the upper, down for the lower lip
    turn_deg: tuple[float, float] = _vector(
        2, -90.0, 90.0, default=(0.0, 0.0)
    )  # about the centre: what lies above it goes forward, what lies before it to the side
    opening: tuple[float, float] = _vector(
        2, 0.0, 30.0, default=(0.0, 0.0)
    )  # mm, half width and half height of the oval mouth drawn to; both 0: to the centre
    arc_deg: tuple[float, float, float] = _vector(3, -360.0, 360.0, default=(0.0, 180.0, 1.0))


@dataclass(frozen=True)
class LidMuscle(Muscle):
    """A muscle that turns an eyelid over the eyeball."""

    lid: str = _choice(LIDS, default="upper_close")
    travel: float = _number(0.0, 2.0, default=1.0)  # x the lid aperture at full activation


@dataclass(frozen=True)
class Rig:
    """A whole rig; `Rig()` is plain tissue with a jaw and no muscles."""

    tissue: Tissue = Tissue()
    jaw: Jaw = Jaw()
    eyes: Eyes = Eyes()
    head: Head = Head()
    muscles: tuple[Muscle, ...] = ()
