"""One substep of the face, compiled: all forces on the skin, Euler's step, all contacts.

tissue.py, contact.py and teeth.py explain the physics. The arguments are the named tuples of
state.py and skin_model.py. All kernels are in this file, so that a substep can be read from top to
bottom, except the contact with the eyeballs (eye_contact.py).

A frame is cut into ticks, a tick into substeps:

    tick      at most 1/60 s: bones, lids and muscle pulls are computed for the activations in the
              middle of the tick, so the error of their delay is second order
    substep   at most 1/300 s: forces, velocity, position, contact

A frame of any length is divided into equal ticks and substeps, so no remainder is carried, and
there is no jitter at odd frame rates. Masses are raised where the longest substep would be unstable
(tissue.py), so all shorter substeps are stable as well. Damping is implicit and differs by vertex:
it is near critical for the springs that hold the vertex, because a single constant would allow
overshoot where a muscle stiffens the skin.

Source: Kähler et al. 2001, section 3 (mass-spring skin); semi-implicit Euler instead of Verlet;
step, mass scaling and damping were measured here.
"""

from __future__ import annotations

import math

import numpy as np

from ..geometry.arrays import Floats64
from ..geometry.vectors import (
    add_to_row,
    dot,
    less,
    rotated,
    rotated_back,
    row_of,
    times,
    vector_of,
    write_row,
)
from ..jit import njit
from .contact import SLIDE_DISTANCE, LipPairs
from .eye_contact import keep_out_of_eyeballs, lift_triangles, stop_approach
from .skin_model import SkinModel, Tick
from .skull import RigidMotion
from .state import State
from .teeth import Teeth
from .tissue import EdgeSprings, TissueSprings

LONGEST_FRAME = 1.0 / 20.0  # s, the longest allowed `dt`
# s: all skin is 24 % heavier than its own mass; 1/360 s gives 14 % and costs a fifth more
LONGEST_SUBSTEP = 1.0 / 300.0
STEP_ROUNDING = 0.02  # parts: a caller's 0.0167 for 1/60 s is still one tick, not two
SEAL_AXES = (0.5, 1.0, 0.5)  # the seal's stiffness sideways, up and down, forward (last fitted)


def ticks_in(dt: float) -> int:
    """Number of ticks in a frame of `dt` [s]."""
    longest_tick = 1.0 / 60.0  # s: shorter ticks gain nothing, because a tick uses its middle
    return parts(dt, longest_tick)


def substeps_in(tick: float) -> int:
    """Number of substeps in a tick [s]."""
    return parts(tick, LONGEST_SUBSTEP)


def parts(whole: float, longest: float) -> int:
    """Return the number of equal parts of a time [s], none longer than `longest`."""
    return max(1, math.ceil(whole / longest - STEP_ROUNDING))


@njit
def advance(state: State, skin: SkinModel, tick: Tick) -> None:
    """Advance a face by one tick in substeps; the code lists all forces and constraints."""
    damp(state, skin, tick.h)
    lip_passes = 7  # averaged projections need several passes where lips are pressed hard
    for _ in range(tick.substeps):
        tissue_forces(state, skin.tissue)
        edge_forces(state, skin.edges)
        accelerate(state)
        hold_lips(state, skin, tick)
        move(state, tick.h)
        for _ in range(lip_passes):
            keep_lips_apart(state, skin, tick.grip.overlap)
        keep_out_of_eyeballs(state, skin.eyes, tick.looks)
        keep_out_of_teeth(state, skin.teeth, tick.mandible)
    lift_triangles(state, skin.eyes, tick.looks)


@njit
def damp(state: State, skin: SkinModel, h: float) -> None:
    """Prepare the decay of velocities by damping, and their gain per force, for this tick."""
    mass = skin.mass
    tissue = skin.tissue
    for i in range(len(mass)):
        rate = np.sqrt((tissue.tangential[i] + state.hold[i]) / mass[i])
        damping = tissue.damping + 2.0 * tissue.damping_ratio * rate
        state.decay[i] = 1.0 / (1.0 + h * damping)
        state.gain[i] = state.decay[i] * h / mass[i]


@njit
def tissue_forces(state: State, springs: TissueSprings) -> None:
    """Set `state.offset`, and set `state.force` to the pull of bones and muscles."""
    x = state.x
    carried = state.carried
    normals = state.normals
    hold = state.hold
    pull = state.pull
    offset = state.offset
    force = state.force
    tangential = springs.tangential
    normal = springs.normal
    for i in range(len(x)):
        away = less(row_of(x, i), 1.0, row_of(carried, i))
        write_row(offset, i, away)
        outward = row_of(normals, i)
        across = (normal[i] - tangential[i]) * dot(away, outward)
        along = tangential[i] + hold[i]
        without_normal = less(row_of(pull, i), along, away)
        write_row(force, i, less(without_normal, across, outward))


@njit(fastmath={"contract"})
def edge_forces(state: State, springs: EdgeSprings) -> None:
    """Add the pull of all edges to `state.force`; `state.offset` must be up to date.

    There are three passes. The second pass writes no shared entries, so roots and quotients are
    vectorised. The third pass loads each vertex once for all edges that begin there.
    """
    x = state.x
    offset = state.offset
    force = state.force
    tension = state.tension
    edges = springs.edges
    rows = springs.rows
    rest_length = springs.rest_length
    stiffness = springs.stiffness
    shear = springs.shear
    strain_limit = springs.strain_limit
    extra = springs.stiffening - 1.0
    for e in range(len(edges)):
        i = edges[e, 0]
        j = edges[e, 1]
        dx = x[j, 0] - x[i, 0]
        dy = x[j, 1] - x[i, 1]
        dz = x[j, 2] - x[i, 2]
        tension[e] = dx * dx + dy * dy + dz * dz
    shortest_edge = 1e-6  # mm: the direction of a shorter edge is noise
    for e in range(len(edges)):
        length = max(np.sqrt(tension[e]), shortest_edge)
        extension = length - rest_length[e]
        beyond = max(extension - strain_limit * rest_length[e], 0.0)
        tension[e] = stiffness[e] * (extension + extra * beyond) / length
    for i in range(len(x)):
        ax = x[i, 0]
        ay = x[i, 1]
        az = x[i, 2]
        bx = offset[i, 0]
        by = offset[i, 1]
        bz = offset[i, 2]
        sx = 0.0
        sy = 0.0
        sz = 0.0
        for e in range(rows[i], rows[i + 1]):
            j = edges[e, 1]
            t = tension[e]
            s = shear[e]
            fx = t * (x[j, 0] - ax) + s * (offset[j, 0] - bx)
            fy = t * (x[j, 1] - ay) + s * (offset[j, 1] - by)
            fz = t * (x[j, 2] - az) + s * (offset[j, 2] - bz)
            sx += fx
            sy += fy
            sz += fz
            force[j, 0] -= fx
            force[j, 1] -= fy
            force[j, 2] -= fz
        force[i, 0] += sx
        force[i, 1] += sy
        force[i, 2] += sz


@njit
def accelerate(state: State) -> None:
    """First half of semi-implicit Euler: velocities from forces and damping."""
    v = state.v
    force = state.force
    for i in range(len(v)):
        decay = state.decay[i]
        gain = state.gain[i]
        for k in range(3):
            v[i, k] = decay * v[i, k] + gain * force[i, k]


@njit
def hold_lips(state: State, skin: SkinModel, tick: Tick) -> None:
    """Change velocities by the pull that the seal has at the end of the substep (implicit Euler).

    The distance c of a pair grows at speed s; w is the inverse mass. An implicit spring gives the
    new speed (s - h k w c) / (1 + h^2 k w), which is stable for any stiffness k. The mass of a
    vertex in several pairs is split among them (mass splitting, Tonge et al. 2012), so a weak seal
    pulls with its full force for any number of pairs.
    """
    rest = skin.rest
    mass = skin.mass
    lips = skin.lips
    grip = tick.grip
    h = tick.h
    if grip.gap_stiffness <= 0.0:
        return
    x = state.x
    v = state.v
    change = state.work
    change[:] = 0.0
    for p in range(len(lips.vertex)):
        i = lips.vertex[p]
        a = lips.beside[p, 0]
        b = lips.beside[p, 1]
        w = lips.weight[p]
        inverse = inverse_mass(lips, p, mass) / lips.averaging[p]
        for k in range(3):
            apart = motion_apart(x, rest, (i, a, b), w, k)
            firmness = grip.stiffness
            if k == 1:
                apart -= lips.below[p] * grip.overlap
                if lips.below[p] * apart < 0.0:
                    firmness = grip.gap_stiffness
            speed = speed_apart(v, (i, a, b), w, k)
            give = h * inverse * firmness * lips.seal[p] * SEAL_AXES[k]
            slowed = (speed - give * apart) / (1.0 + h * give)
            impulse = (slowed - speed) / inverse
            change[i, k] += impulse / mass[i]
            change[a, k] -= w * impulse / mass[a]
            change[b, k] -= (1.0 - w) * impulse / mass[b]
    for row in range(len(lips.members)):
        i = lips.members[row]
        for k in range(3):
            v[i, k] += change[i, k]


@njit
def motion_apart(
    x: Floats64, rest: Floats64, pair: tuple[int, int, int], w: float, axis: int
) -> float:
    """How far a vertex of one lip moved from rest, relative to its point of the other lip [mm].

    pair: the vertex, and both ends of the point's segment. w: weight of the first end.
    """
    i, a, b = pair
    moved_a = x[a, axis] - rest[a, axis]
    moved_b = x[b, axis] - rest[b, axis]
    moved = x[i, axis] - rest[i, axis]
    apart: float = moved - (w * moved_a + (1.0 - w) * moved_b)
    return apart


@njit
def speed_apart(v: Floats64, pair: tuple[int, int, int], w: float, axis: int) -> float:
    """Speed of a vertex relative to its point of the other lip; pair, w: as in `motion_apart`."""
    i, a, b = pair
    speed: float = v[i, axis] - w * v[a, axis] - (1.0 - w) * v[b, axis]
    return speed


@njit
def inverse_mass(lips: LipPairs, p: int, mass: Floats64) -> float:
    """The inverse mass of a pair of lips, where an impulse parts its vertex and its point."""
    w = lips.weight[p]
    vertex = 1.0 / mass[lips.vertex[p]]
    first = w * w / mass[lips.beside[p, 0]]
    second = (1.0 - w) * (1.0 - w) / mass[lips.beside[p, 1]]
    return float(vertex + first + second)


@njit
def move(state: State, h: float) -> None:
    """Second half: positions from the new velocities."""
    x = state.x
    v = state.v
    # In mm/s per axis: a face never reaches this speed, but a vertex after a caller's `kick` may.
    largest_speed = 5000.0
    for i in range(len(x)):
        for k in range(3):
            v[i, k] = min(max(v[i, k], -largest_speed), largest_speed)
            x[i, k] += h * v[i, k]


@njit
def keep_lips_apart(state: State, skin: SkinModel, overlap: float) -> None:
    """Move lips that cross by more than `overlap` [mm] apart, and stop their approach."""
    rest = skin.rest
    mass = skin.mass
    lips = skin.lips
    x = state.x
    v = state.v
    change = state.work  # of each vertex, columns: height, speed upward
    crossed = False
    slide_fade = 3.0  # mm over which contact fades as the lower lip passes the upper lip
    for p in range(len(lips.vertex)):
        i = lips.vertex[p]
        a = lips.beside[p, 0]
        b = lips.beside[p, 1]
        w = lips.weight[p]
        below = lips.below[p]
        gap = below * (w * x[a, 1] + (1.0 - w) * x[b, 1] - x[i, 1])
        deep = lips.least_gap[p] - overlap - gap
        if deep <= 0.0:
            continue
        forward = motion_apart(x, rest, (i, a, b), w, 2)
        full = min(max(1.0 - (abs(forward) - SLIDE_DISTANCE) / slide_fade, 0.0), 1.0)
        if full == 0.0:
            continue
        if not crossed:
            change[:] = 0.0
            crossed = True
        inverse = inverse_mass(lips, p, mass)
        push = below * full * lips.averaging[p] * deep / inverse
        approach = below * speed_apart(v, (i, a, b), w, 1)
        stop = below * full * lips.averaging[p] * max(approach, 0.0) / inverse
        change[i, 0] -= push / mass[i]
        change[a, 0] += w * push / mass[a]
        change[b, 0] += (1.0 - w) * push / mass[b]
        change[i, 1] -= stop / mass[i]
        change[a, 1] += w * stop / mass[a]
        change[b, 1] += (1.0 - w) * stop / mass[b]
    if crossed:
        for row in range(len(lips.members)):
            i = lips.members[row]
            x[i, 1] += change[i, 0]
            v[i, 1] += change[i, 1]


@njit
def keep_out_of_teeth(state: State, teeth: Teeth, mandible: RigidMotion) -> None:
    """Move skin out of the dental arches, away from their axes, and stop its approach.

    The lower arch moves with the mandible.
    """
    x = state.x
    v = state.v
    turn = mandible.rotation
    shift = mandible.shift
    arch = teeth.arch
    tooth_fade = 3.0  # mm above and below the teeth over which their contact fades
    least_ratio = 0.1  # share of an arch's radius: nearer to the axis, outward is ambiguous
    for c in range(len(teeth.vertex)):
        i = teeth.vertex[c]
        width = arch[c, 0]
        depth = arch[c, 1]
        axis = arch[c, 2]
        low = arch[c, 3]
        high = arch[c, 4]
        point = row_of(x, i)
        if teeth.lower[c]:  # into the mandible's own space
            point = rotated_back(turn, less(point, 1.0, vector_of(shift)))
        aside, height, forward = point
        beyond = max(low - height, height - high, 0.0)
        ahead = forward - axis
        if beyond >= tooth_fade or ahead <= 0.0:
            continue
        radius_ratio = np.sqrt((aside / width) ** 2 + (ahead / depth) ** 2)
        sunk = (teeth.least[c] - radius_ratio) * (1.0 - beyond / tooth_fade)
        if sunk <= 0.0 or radius_ratio < least_ratio:
            continue
        out = times(sunk / radius_ratio, (aside, 0.0, ahead))
        if teeth.lower[c]:
            out = rotated(turn, out)
        add_to_row(x, i, out)
        stop_approach(v, i, out)
