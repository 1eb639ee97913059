"""Contact of skin with the eyeballs and their corneas: what may touch, and how it is kept out.

After each substep vertices are projected out of ball and cornea. Triangles of a coarse lid are flat
between their vertices, and a turned cornea would pierce them. So long triangles are tested at
points all over them after each tick, which is enough, because nobody sees the skin in between.

Source: own; projection by weights as in Müller et al. 2007, "Position based dynamics", section 3.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Integers32, Integers64
from ..geometry.normals import cross_products
from ..geometry.records import joined
from ..geometry.vectors import Vector, add_to_row, dot, less, plus, row_of, times
from ..jit import njit
from .rig import Triple
from .skull import Eyeball, ball_surface
from .state import State
from .surface import SkinSurface

EYE_CLEARANCE = 0.3  # mm between a vertex and the eyeball: thickness of a lid


class Balls(NamedTuple):
    """The eyeballs of a face."""

    centres: Floats64  # (eyes, 3)
    radii: Floats64  # (eyes,)
    irises: Floats64  # (eyes,) mm, radii of the irises
    tops: Floats64  # (eyes,) mm, distance that skin keeps from the centre before the pupil


class NearVertices(NamedTuple):
    """Vertices near an eyeball; each belongs to one."""

    vertex: Integers32  # (C,)
    eye: Integers32  # (C,)
    least: Floats64  # (C,) mm, least distance from the centre beside the cornea
    sunk: Floats64  # (C,) mm, depth at rest


class LongTriangles(NamedTuple):
    """Triangles that face away from an eyeball, and may cut it between their vertices."""

    faces: Integers32  # (T, 3)
    eye: Integers32  # (T,)
    reach: Floats64  # (T,) mm, least distance of the corners at which no point is too near
    least: Floats64  # (T, S) mm, as of a vertex, for each tested point
    sunk: Floats64  # (T, S) mm
    shares: Floats64  # (S, 3) barycentric coordinates of the points that are tested
    corners: Integers32  # (n,) vertices of the triangles
    corner_eye: Integers32  # (n,)


class EyeContact(NamedTuple):
    """Skin near the eyeballs.

    Skin that is nearer to a ball at rest than a lid is thick may stay as deep.
    """

    balls: Balls
    near: NearVertices
    long: LongTriangles

    def deepest(self, x: Floats64, looks: Floats64) -> float:
        """Greatest depth of vertices (V, 3) inside an eyeball [mm]; looks: see `Bones.looks`."""
        balls = self.balls
        near = self.near
        away = x[near.vertex] - balls.centres[near.eye]
        distance = np.linalg.norm(away, axis=1)
        ahead = (away * looks[near.eye]).sum(axis=1) / np.maximum(distance, 1e-9)
        least = near.least.copy()
        for eye, (radius, iris) in enumerate(zip(balls.radii, balls.irises, strict=True)):
            own = near.eye == eye
            surface = ball_surface(ahead[own], radius, iris)
            least[own] = np.maximum(least[own], surface + EYE_CLEARANCE - near.sunk[own])
        return float((least - distance).max(initial=0.0))


def watch_eyeballs(surface: SkinSurface, eyeballs: tuple[Eyeball, ...]) -> EyeContact:
    """Find the skin that could touch an eyeball; skin inside it may not sink deeper."""
    balls = Balls(
        centres=np.array([ball.centre for ball in eyeballs]).reshape(-1, 3),
        radii=np.array([ball.radius for ball in eyeballs]),
        irises=np.array([ball.iris for ball in eyeballs]),
        tops=np.array([_top_of(ball) for ball in eyeballs]),
    )
    near = [_vertices_near_ball(surface.positions, ball) for ball in eyeballs]
    return EyeContact(
        balls, _near_vertices(surface, eyeballs, near), _long_triangles(surface, eyeballs, near)
    )


def _top_of(ball: Eyeball) -> float:
    """Distance that skin keeps from the centre of a ball before the pupil [mm]."""
    return float(ball_surface(1.0, ball.radius, ball.iris)) + EYE_CLEARANCE


def _near_vertices(
    surface: SkinSurface, eyeballs: tuple[Eyeball, ...], near: list[Integers64]
) -> NearVertices:
    """Measure the vertices near each ball at rest; near: their indices, (n,) for each ball."""
    nobody = np.zeros(0, np.int32)
    found = [NearVertices(nobody, nobody, np.zeros(0), np.zeros(0))]
    for number, (ball, vertex) in enumerate(zip(eyeballs, near, strict=True)):
        least, sunk = _kept_out(surface.positions[vertex], ball)
        eye = np.full(len(vertex), number, np.int32)
        found.append(NearVertices(vertex.astype(np.int32), eye, least, sunk))
    return joined(found)


def _long_triangles(
    surface: SkinSurface, eyeballs: tuple[Eyeball, ...], near: list[Integers64]
) -> LongTriangles:
    """Find and measure the long triangles near each ball; near: as in `_near_vertices`."""
    x = surface.positions
    shares = barycentric_grid()
    no_points = np.zeros((0, len(shares)))
    no_faces = np.zeros((0, 3), np.int32)
    rows = [(no_faces, np.zeros(0, np.int64), np.zeros(0), no_points, no_points)]
    for number, (ball, vertex) in enumerate(zip(eyeballs, near, strict=True)):
        faces, longest = _long_faces(surface, vertex, ball)
        # No point of a triangle is farther than this from its nearest corner.
        stretched = 1.3  # times its length at rest that an edge grows at most
        reach = np.sqrt(_top_of(ball) ** 2 + (stretched * longest) ** 2 / 3.0)
        rows.append(
            (faces, np.full(len(faces), number), reach, *_kept_out(shares @ x[faces], ball))
        )
    faces, eye, reach, least, sunk = (np.concatenate(column) for column in zip(*rows, strict=True))
    corners, first = np.unique(faces, return_index=True)
    return LongTriangles(
        faces=faces,
        eye=eye.astype(np.int32),
        reach=reach,
        least=least,
        sunk=sunk,
        shares=shares,
        corners=corners.astype(np.int32),
        corner_eye=np.repeat(eye, 3)[first].astype(np.int32),
    )


def _vertices_near_ball(x: Floats64, ball: Eyeball) -> Integers64:
    """Vertices (n,) of `x` (V, 3) that could touch a ball."""
    eye_reach = 12.0  # mm around an eyeball in which skin is watched
    return np.flatnonzero(np.linalg.norm(x - ball.centre, axis=1) < ball.radius + eye_reach)


def _kept_out(points: Floats64, ball: Eyeball) -> tuple[Floats64, Floats64]:
    """Least distance beside the cornea, and depth at rest, of points (..., 3) of the skin [mm]."""
    away = points - ball.centre
    distance = np.linalg.norm(away, axis=-1)
    ahead = away[..., 2] / np.maximum(distance, 1e-9)
    surface = ball_surface(ahead, ball.radius, ball.iris) + EYE_CLEARANCE
    return np.minimum(distance, ball.radius + EYE_CLEARANCE), np.maximum(surface - distance, 0.0)


def _long_faces(
    surface: SkinSurface, vertices: Integers64, ball: Eyeball
) -> tuple[Integers32, Floats64]:
    """Triangles (T, 3) of some vertices whose middle may cut a ball while their corners touch it.

    Also returns their longest edges [mm], (T,). They face away from the ball; others are the wall
    of a socket, or the inner side of a lid.
    """
    cornea_radius = 7.8  # mm
    # The middle of such an edge is deeper than its ends by a lid's thickness.
    short = np.sqrt(8.0 * cornea_radius * EYE_CLEARANCE)
    x = surface.positions
    faces: Integers32 = surface.faces[np.isin(surface.faces, vertices).all(axis=1)]
    edges = x[np.roll(faces, -1, axis=1)] - x[faces]
    longest = np.linalg.norm(edges, axis=2).max(axis=1, initial=0.0)
    outward = (cross_products(x, faces) * (x[faces].mean(axis=1) - ball.centre)).sum(axis=1)
    chosen = (longest > short) & (outward > 0.0)
    return faces[chosen], longest[chosen]


def barycentric_grid() -> Floats64:
    """Return the barycentric coordinates of points all over a triangle, shape (S, 3)."""
    edge_steps = 6  # parts of each edge; a triangle is compared with the eyeball at their ends
    first, second = np.indices((edge_steps + 1, edge_steps + 1)).reshape(2, -1)
    steps = np.column_stack([first, second, edge_steps - first - second])
    is_within = steps[:, 2] >= 0
    return steps[is_within] / edge_steps


@njit
def keep_out_of_eyeballs(state: State, eyes: EyeContact, looks: Floats64) -> None:
    """Move vertices out of the eyeballs and their corneas, and stop their approach.

    looks: unit vector along which each eyeball looks, (eyes, 3).
    """
    x = state.x
    balls = eyes.balls
    near = eyes.near
    for c in range(len(near.vertex)):
        i = near.vertex[c]
        e = near.eye[c]
        ball = (balls.radii[e], balls.irises[e], balls.tops[e])
        away = less(row_of(x, i), 1.0, row_of(balls.centres, e))
        depth = depth_in_ball(away, row_of(looks, e), ball, (near.least[c], near.sunk[c]))
        if depth > 0.0:
            push_out(state, i, away, depth)


@njit
def lift_triangles(state: State, eyes: EyeContact, looks: Floats64) -> None:
    """Move long triangles that cut an eyeball outward, and stop the approach of their corners.

    Corners move away from the ball's centre, by their weights in the deepest point (lid_lift.py).
    A corner of several triangles moves as far as one of them needs.
    """
    x = state.x
    balls = eyes.balls
    long = eyes.long
    shares = long.shares
    lift = state.work  # first column: of each vertex [mm]
    cut = False
    for t in range(len(long.faces)):
        a, b, c = long.faces[t]
        e = long.eye[t]
        centre = row_of(balls.centres, e)
        to_a = length(less(row_of(x, a), 1.0, centre))
        to_b = length(less(row_of(x, b), 1.0, centre))
        to_c = length(less(row_of(x, c), 1.0, centre))
        if min(to_a, to_b, to_c) > long.reach[t]:
            continue
        ball = (balls.radii[e], balls.irises[e], balls.tops[e])
        deepest = 0.0
        where = 0
        for s in range(len(shares)):
            away = less(in_triangle(x, (a, b, c), shares[s]), 1.0, centre)
            kept = (long.least[t, s], long.sunk[t, s])
            depth = depth_in_ball(away, row_of(looks, e), ball, kept)
            if depth > deepest:
                deepest = depth
                where = s
        if deepest == 0.0:
            continue
        if not cut:
            lift[:, 0] = 0.0
            cut = True
        weight = row_of(shares, where)
        part = deepest / dot(weight, weight)
        for k in range(3):
            i = long.faces[t, k]
            lift[i, 0] = max(lift[i, 0], part * weight[k])
    if cut:
        for row in range(len(long.corners)):
            i = long.corners[row]
            if lift[i, 0] > 0.0:
                centre = row_of(balls.centres, long.corner_eye[row])
                push_out(state, i, less(row_of(x, i), 1.0, centre), lift[i, 0])


@njit
def in_triangle(x: Floats64, corners: tuple[int, int, int], weight: Floats64) -> Vector:
    """The point of a triangle with barycentric coordinates (3,)."""
    a, b, c = corners
    first_two = plus(times(weight[0], row_of(x, a)), times(weight[1], row_of(x, b)))
    return plus(first_two, times(weight[2], row_of(x, c)))


@njit
def length(vector: Vector) -> float:
    """Length of a vector."""
    return math.sqrt(dot(vector, vector))


@njit
def depth_in_ball(away: Vector, look: Vector, ball: Triple, kept: tuple[float, float]) -> float:
    """How far a point must move outward [mm], 0 or less for a point outside an eyeball.

    away: from the ball's centre [mm]. look: unit vector along which the ball looks. ball:
    radii of ball and iris, and distance that skin keeps from the centre before the pupil [mm].
    kept: the point's `least` and `sunk` of `NearVertices` [mm].
    """
    radius, iris, top = ball
    least, sunk = kept
    distance = length(away)
    if distance >= top or distance == 0.0:
        return 0.0
    ahead = dot(away, look) / distance
    surface = ball_surface(ahead, radius, iris) + EYE_CLEARANCE
    depth: float = max(least, surface - sunk) - distance
    return depth


@njit
def push_out(state: State, i: int, away: Vector, way: float) -> None:
    """Move a vertex by `way` [mm] along the vector `away`, and stop its approach against it."""
    add_to_row(state.x, i, times(way / length(away), away))
    stop_approach(state.v, i, away)


@njit
def stop_approach(v: Floats64, i: int, out: Vector) -> None:
    """Remove the component of a vertex's velocity that points against `out`, the way out."""
    approach = dot(row_of(v, i), out) / max(dot(out, out), 1e-18)
    if approach < 0.0:
        add_to_row(v, i, times(-approach, out))
