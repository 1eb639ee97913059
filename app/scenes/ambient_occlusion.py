"""How open the skin is to light from all around: ambient occlusion, baked once for a head.

That of the built-in head is shipped; `python -m risorius.app.scenes.ambient_occlusion [FILE]` bakes
it anew for other data. A head of one's own is baked when it is loaded.

From each vertex rays go out over its normal, more of them the closer they are to it, as light that
comes from everywhere counts. What a ray meets within REACH takes its part of the light away, less
the farther it is. A face moves: what touches at rest, lips or the folds of lids, may come to light
later. So two poses are looked at, at rest and with mouth open and eyes shut, and the more open one
counts. The program looks at the finest mesh of a head, which takes a minute.

Sources: Zhukov, Iones, Kronin 1998, "An ambient light illumination model" (obscurance that fades
with distance); Möller and Trumbore 1997 (ray and triangle).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from risorius import assets, sim
from risorius.assets.fitting.warp import nearest_on
from risorius.assets.loading import HEAD_FILE, load_head
from risorius.assets.model import FineMesh
from risorius.assets.topology import decimated
from risorius.geometry.normals import vertex_normals
from risorius.geometry.texels import Texels
from risorius.jit import njit

from ..errors import report_user_errors
from ..files import check_file, written_atomically
from ..stopping import handle_signals

REACH = 45.0  # [mm] beyond which nothing shades
MOST_SEEN = 6000  # triangles that rays are cast at: more would take seconds, and look the same
RAYS = 48  # from each vertex
DEPTH = 1.6  # power of what is left; chosen by eye: folds are told from afar, and nothing is black
REVEALED = 0.8  # most light that comes to what only a moving face shows
START = 0.4  # [mm] above the skin, lest it shade itself
THIN = 5.0  # [mm] a ray may leave what is thinner: at the root of an ear it begins within the ear
REVEALING = ("yawn", "jaw_open")  # the first of these that a head knows opens mouth and shuts eyes
SETTLED = 60  # steps of 1/60 s
MARGIN = 3.0  # [texels] painted beyond a triangle, for texels between patches
SOFT = 1.5  # [texels] of the blur in which what single rays tell is lost

Points = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int32]
Values = npt.NDArray[np.float32]


def ambient_occlusion(
    head: Any, simulation: sim.Simulation, fine: FineMesh | None = None
) -> npt.NDArray[np.uint8]:
    """An image over the head's texture: 255 where all light comes in, 0 where none; (H, W).

    head: with texture coordinates `uv`, `face_uv` and `albedo` (H, W, 3).
    simulation: of that head, at rest; it is moved, and at rest again at the end.
    fine: a finer mesh of the head, to be looked at instead of its own.
    """
    rest, places = simulation.positions.copy(), head.uv.astype(np.float64)[head.face_uv]
    numbers, faces = _looked_through(rest, simulation.faces)
    points = rest[numbers]
    if fine is not None:
        points, faces, places = fine.vertices, fine.faces, fine.interpolate(head.uv)[fine.faces]
    values = open_to_light(points, faces, np.arange(len(points)))
    name = next((each for each in REVEALING if each in simulation.limits), None)
    if name is not None:
        simulation.set(name, 1.0)
        for _ in range(SETTLED):
            simulation.step(1.0 / 60.0)
        ways, hidden = simulation.positions - rest, np.flatnonzero(values < REVEALED)
        moved = points + (ways[numbers] if fine is None else fine.interpolate(ways))
        revealed = open_to_light(moved, faces, hidden)
        values[hidden] = np.maximum(values[hidden], REVEALED * revealed)
        simulation.reset()
    shades = values**DEPTH
    if len(faces) < len(simulation.faces):
        near = nearest_on(rest, vertex_normals(rest, simulation.faces), points, faces)
        shades, faces = near.interpolate(shades).astype(np.float32), simulation.faces
    # What is meant lies over what overlaps; and folds that another head's texture shows twice, such
    # as the inside of a nostril, must not darken the open skin there: the more open one counts.
    size = head.albedo.shape[:2]
    around, inside = (_painted(places, shades[faces], margin, size) for margin in (MARGIN, 0.0))
    image = np.where(inside > 0.0, inside, np.where(around > 0.0, around, 1.0))
    softened: Values = scipy.ndimage.gaussian_filter(image, SOFT)
    return np.round(255.0 * softened).astype(np.uint8)


def _looked_through(positions: Points, faces: Triangles) -> tuple[npt.NDArray[np.intp], Triangles]:
    """Vertices of a mesh and triangles between them that are enough to see what is open."""
    if len(faces) <= MOST_SEEN:
        return np.arange(len(positions)), faces
    points, triangles = decimated(positions, faces, MOST_SEEN)
    numbers, seen = np.unique(
        scipy.spatial.cKDTree(positions).query(points)[1], return_inverse=True
    )
    triangles = seen[triangles].astype(np.int32)
    is_sound = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return numbers, np.ascontiguousarray(triangles[is_sound])


def open_to_light(positions: Points, faces: Triangles, numbers: npt.NDArray[np.intp]) -> Values:
    """The share of the light from all around that reaches vertices of these numbers, 0..1."""
    corners = positions[faces]
    normals = vertex_normals(positions, faces)[numbers]
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    values = np.empty(len(numbers), np.float32)
    _cast(positions[numbers], normals, corners, middles, radii, _hemisphere(), values)
    return values


def _hemisphere() -> Points:
    """Directions above the plane z = 0, as many as go with the cosine; shape (RAYS, 3)."""
    steps = np.arange(RAYS) + 0.5
    outward, turn = np.sqrt(steps / RAYS), steps * np.pi * (3.0 - np.sqrt(5.0))
    up = np.sqrt(1.0 - outward**2)
    return np.stack([outward * np.cos(turn), outward * np.sin(turn), up], axis=1)


@njit
def _cast(
    positions: Points,
    normals: Points,
    corners: Points,
    middles: Points,
    radii: Points,
    directions: Points,
    values: Values,
) -> None:
    near = np.empty((len(corners), 9), np.float32)
    for v in range(len(positions)):
        normal = normals[v]
        eye = positions[v] + START * normal
        count = 0
        for t in range(len(corners)):
            away = middles[t] - eye
            reach = REACH + radii[t]
            # Nothing below the plane of the vertex can be met.
            if np.dot(away, away) < reach * reach and np.dot(away, normal) > -radii[t]:
                for i in range(3):
                    near[count, i] = corners[t, 0, i] - eye[i]
                    near[count, 3 + i] = corners[t, 1, i] - corners[t, 0, i]
                    near[count, 6 + i] = corners[t, 2, i] - corners[t, 0, i]
                count += 1
        # Any two directions across the normal.
        side = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.6 else np.array([0.0, 1.0, 0.0])
        first = np.cross(normal, side)
        first /= max(np.sqrt(np.dot(first, first)), 1e-12)
        second = np.cross(normal, first)
        lost = 0.0
        for r in range(len(directions)):
            ray = directions[r, 0] * first + directions[r, 1] * second + directions[r, 2] * normal
            nearest = _nearest(ray.astype(np.float32), near, count)
            lost += 1.0 - nearest / REACH
        values[v] = 1.0 - lost / len(directions)


@njit
def _nearest(ray: Values, near: Values, count: int) -> float:
    """How far a ray goes before it meets a triangle, at most REACH.

    near: a corner, as seen from where the ray begins, and the sides from there; shape (.., 9).
    """
    x, y, z = ray
    nearest = np.float32(REACH)
    zero, one = np.float32(0.0), np.float32(1.0)
    for t in range(count):
        ux, uy, uz = near[t, 3], near[t, 4], near[t, 5]
        wx, wy, wz = near[t, 6], near[t, 7], near[t, 8]
        px, py, pz = y * wz - z * wy, z * wx - x * wz, x * wy - y * wx
        size = ux * px + uy * py + uz * pz
        part = one / size if size != zero else zero
        sx, sy, sz = -near[t, 0], -near[t, 1], -near[t, 2]
        b = (sx * px + sy * py + sz * pz) * part
        qx, qy, qz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
        c = (x * qx + y * qy + z * qz) * part
        distance = (wx * qx + wy * qy + wz * qz) * part
        is_met = (b >= zero) & (c >= zero) & (b + c <= one) & (distance > zero)
        is_met &= (size > zero) | (distance > np.float32(THIN))
        if is_met and distance < nearest:
            nearest = distance
    return float(nearest)


def _painted(places: Points, values: Values, margin: float, size: tuple[int, int]) -> Values:
    """An image of triangles and a margin beside them, straight between values at corners.

    Where they overlap the greatest value counts; 0 where no triangle is.
    """
    texels = Texels.within(places, size, margin)
    image = np.zeros(size, np.float32)
    np.maximum.at(image, (texels.rows, texels.columns), texels.interpolate(values))
    return image


def bake(head: assets.Head) -> dict[str, npt.NDArray[np.generic]]:
    """Make everything that `head.ambient_occlusion_file` holds, array name -> array."""
    return {
        "ambient_occlusion": ambient_occlusion(head, sim.create(head), head.finer(2)),
        "made_from": np.array(head.fingerprint, dtype=np.uint32),
    }


def main(arguments: Sequence[str]) -> None:
    """Bake the light on a head into the file beside its data file."""
    parser = argparse.ArgumentParser(
        prog="python -m risorius.app.scenes.ambient_occlusion",
        description=(__doc__ or "").splitlines()[0],
    )
    parser.add_argument("file", nargs="?", type=Path, default=HEAD_FILE, help="the data file")
    head = load_head(parser.parse_args(arguments).file)
    target = head.ambient_occlusion_file
    check_file(target)
    arrays = bake(head)
    with written_atomically(target) as part:
        np.savez_compressed(part, allow_pickle=False, **arrays)


if __name__ == "__main__":
    handle_signals()
    with report_user_errors():
        main(sys.argv[1:])
