"""Measure the distance of a head from the nearest person of a reference, by region.

The mean person of a reference is rotated, moved and deformed along the modes until it fits the head
as closely as possible. The remaining difference is reported as the RMS distance along the head's
normals, and as the median angle between normals; normals show form, while distances between
landmarks do not. Large weights mean an unusual head. For real people fitted with half of the modes,
the difference is 0.33 to 0.48 mm and 2.6 to 3.7 degrees.

Vertices in nostrils and between lips are left out, because meshes differ there. Source of the fit:
Amberg, Knothe, Vetter 2008, "Expression invariant 3D face recognition with a morphable model" (it
alternates between the search for nearest points and the solution for weights).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import scipy

from risorius import assets
from risorius.app.errors import UserError
from risorius.assets.fitting.warp import nearest_on
from risorius.assets.loading import load_head
from risorius.geometry.arrays import Flags, Floats64, Integers32
from risorius.geometry.closest import closest_points
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals

from .averages import median, root_mean_square
from .report import Target, at_most, table
from .subjects import DENSE_FILE, MILLIMETRES_PER_CENTIMETRE, MODES_FILE, read_arrays

Rotation = scipy.spatial.transform.Rotation
Labels = npt.NDArray[np.str_]

# [mm] Largest RMS distance of the finer mesh.
MOST_DISTANCES = {"all": 0.50, "nose": 0.60, "mouth": 0.60}
REGION_NAMES = ("forehead", "eyes", "nose", "cheek", "mouth", "chin", "jaw")


@dataclass(frozen=True)
class IdentitySpace:
    """A linear model of people's heads: mean + weights @ modes [mm].

    It is read from a folder made by `bench reference`. `identity_modes.npz` there holds `modes` (k,
    V, 3) [cm]: the displacement of the vertices of `face.npz` by each component of ICT-FaceKit's
    identity at one standard deviation.
    """

    mean: Floats64
    """Shape (V, 3)."""
    triangles: Integers32
    landmarks: Integers32
    """Vertex indices of the 68 landmarks."""
    modes: Floats64
    """Shape (k, V, 3); a weight of 1 is one standard deviation."""

    @classmethod
    def read(cls, folder: Path) -> IdentitySpace:
        """Read a folder. Raises UserError, which names the file, if something is missing."""
        face = read_arrays(folder / DENSE_FILE, ("vertices", "triangles", "landmarks68"))
        if not (folder / MODES_FILE).is_file():
            raise UserError(f"{folder / MODES_FILE}: is not there; it holds the modes of identity")
        modes = read_arrays(folder / MODES_FILE, ("modes",))["modes"]
        if modes.shape != (len(modes), *face["vertices"].shape):
            raise UserError(f"{folder / MODES_FILE}: 'modes' must move each vertex of {DENSE_FILE}")
        return cls(
            MILLIMETRES_PER_CENTIMETRE * face["vertices"].astype(np.float64),
            face["triangles"].astype(np.int32),
            face["landmarks68"].astype(np.int32),
            MILLIMETRES_PER_CENTIMETRE * modes.astype(np.float64),
        )

    def person(self, weights: Floats64) -> Floats64:
        """The vertices of the person with these weights [mm], shape (V, 3)."""
        return np.asarray(self.mean + np.tensordot(weights, self.modes, 1), dtype=np.float64)

    def regions(self) -> Labels:
        """The name of each vertex's region, "" for hidden ones and outside the face, (V,)."""
        x, y, z = self.mean.T
        marks = self.mean[self.landmarks]
        aside = np.abs(x)
        eyes = marks[36:48, 1].mean()
        below_nose = marks[33, 1] - 6.0
        below_mouth = marks[57, 1] - 4
        is_high = y > marks[17:27, 1].mean() + 8.0
        rules = {
            "forehead": is_high & (y < eyes + 75.0),
            "": is_high,
            "nose": (aside < 22.0) & (y > below_nose) & (y < marks[27, 1]),
            "eyes": (np.abs(y - eyes) < 18.0) & (aside < abs(marks[36, 0]) + 10.0),
            "mouth": (aside < 32.0) & (y > below_mouth) & (y <= below_nose),
            "chin": (aside < 30.0) & (y <= below_mouth),
            "jaw": y <= marks[60:68, 1].mean() + 5.0,
        }
        found = np.select(list(rules.values()), list(rules), "cheek")
        is_face = (z > marks[36, 2] - 45.0) & (y >= marks[8, 1] - 8.0)
        found[~is_face] = ""
        found[self._hidden()] = ""
        return found

    def _hidden(self) -> Flags:
        """Flags of vertices that face other skin straight ahead or in three of seven directions,
        (V,).
        """
        facing = vertex_normals(self.mean, self.triangles)
        aside = unit_vectors(np.cross(facing, np.roll(facing, 1, axis=1)))
        upward = np.cross(facing, aside)
        angles = np.radians(np.arange(0.0, 360.0, 60.0))[:, None, None]
        outward = np.cos(angles) * aside + np.sin(angles) * upward
        slanted = np.sqrt(0.5) * (facing + outward)
        directions = np.concatenate([facing[None], slanted])
        opposite_depth = 12.0  # [mm] on a line of sight within which skin hides a vertex
        distances = np.arange(1.0, opposite_depth)
        points = self.mean + distances[:, None, None, None] * directions
        rows = points.reshape(-1, 3)
        nearest = closest_points(rows, self.mean, self.triangles)
        away = rows - nearest.interpolate(self.mean)
        height = (away * nearest.interpolate(facing)).sum(axis=1)
        is_met = (height < 0.0).reshape(points.shape[:3]).any(axis=0)
        is_met_ahead = is_met[0]
        return np.asarray(is_met_ahead | (is_met.sum(axis=0) > 2))


@dataclass(frozen=True)
class HeadMesh:
    """One mesh of a head [mm], with its unit normals and the points of its 68 landmarks."""

    vertices: Floats64
    faces: Integers32
    normals: Floats64
    landmarks: Floats64


@dataclass(frozen=True)
class Remainder:
    """The difference between a surface and the nearest person of the modes."""

    weights: Floats64
    """Weights of the modes, shape (k,), in standard deviations."""
    distances: Mapping[str, float]
    """RMS by region, and of "all" [mm]; NaN for an empty region."""
    angles: Mapping[str, float]
    """Median angle between normals, by the same regions [deg]."""


def measure(folder: Path, head_file: Path | None = None) -> dict[str, Remainder]:
    """Measure the coarse and the finest mesh of a head; without a file, of the built-in head.

    Raises UserError for a broken folder, AssetError for a broken head.
    """
    space = IdentitySpace.read(folder)
    head = assets.load("head") if head_file is None else load_head(head_file)
    fine = head.finer(2)
    marks = head.vertices[head.landmarks]
    normals = vertex_normals(head.vertices, head.faces)
    labels = space.regions()
    surfaces = {
        "coarse": HeadMesh(head.vertices, head.faces, normals, marks),
        "finer": HeadMesh(fine.vertices, fine.faces, fine.normals, marks),
    }
    return {name: unexplained(space, labels, each) for name, each in surfaces.items()}


def unexplained(space: IdentitySpace, labels: Labels, surface: HeadMesh) -> Remainder:
    """Fit the nearest person of the space to a surface, and measure the remaining difference.

    labels: the region of each of the space's vertices, "" for none.
    """
    asked = np.flatnonzero(labels != "").astype(np.int32)
    count = len(space.modes)
    weights = np.zeros(count)
    marked = space.mean[space.landmarks]
    wanted_middle = surface.landmarks.mean(axis=0)
    turn, _ = Rotation.align_vectors(
        surface.landmarks - wanted_middle, marked - marked.mean(axis=0)
    )
    shift = wanted_middle - turn.apply(marked).mean(axis=0)
    rounds = 18  # of nearest points
    landmark_rounds = 6  # first rounds, in which landmarks are fitted too
    landmark_weight = 0.3  # of 1/mm^2
    farthest_distance = 12.0  # [mm] between matched points
    independent_points = 600  # points that count as independent: neighbours have similar errors
    face_landmarks = slice(17, 68)  # without the outline, which has no fixed place on skin
    for number in range(rounds):
        points = turn.apply(space.person(weights)) + shift
        modes = space.modes @ turn.as_matrix().T
        foot, facing, _ = _nearest_surface_points(points, space.triangles, asked, surface)
        near = np.linalg.norm(foot - points[asked], axis=1) < farthest_distance
        found = asked[near]
        system = _point_derivatives(modes, points, found, facing[near])
        left = ((foot[near] - points[found]) * facing[near]).sum(axis=1)
        correction = independent_points / max(len(found), 1)
        normal = correction * system.T @ system
        right = correction * system.T @ left
        if number < landmark_rounds:
            marks = space.landmarks[face_landmarks]
            off = surface.landmarks[face_landmarks] - points[marks]
            for axis in np.eye(3):
                system = _point_derivatives(modes, points, marks, np.tile(axis, (len(marks), 1)))
                normal += landmark_weight * system.T @ system
                right += landmark_weight * system.T @ off @ axis
        normal[:count, :count] += np.eye(count)  # Gaussian prior of the weights
        right[:count] -= weights
        step = np.linalg.solve(normal, right)
        weights = weights + step[:count]
        moved = Rotation.from_rotvec(step[count : count + 3])
        turn = moved * turn
        shift = moved.apply(shift) + step[count + 3 :]
    points = turn.apply(space.person(weights)) + shift
    foot, facing, cosine = _nearest_surface_points(points, space.triangles, asked, surface)
    away = foot - points[asked]
    near = np.linalg.norm(away, axis=1) < farthest_distance
    distance = (away * facing).sum(axis=1)
    angle = np.degrees(np.arccos(cosine))
    groups = {name: near & (labels[asked] == name) for name in REGION_NAMES} | {"all": near}
    return Remainder(
        weights,
        {name: root_mean_square(distance[group]) for name, group in groups.items()},
        {name: median(angle[group]) for name, group in groups.items()},
    )


def _point_derivatives(
    modes: Floats64, points: Floats64, numbers: Integers32, directions: Floats64
) -> Floats64:
    """Derivative of points along `directions` (n, 3), by modes, turns and shifts, (n, K + 6).

    modes: rotated, shape (K, V, 3). numbers: indices of the points, shape (n,).
    """
    by_modes = np.einsum("kij,ij->ik", modes[:, numbers], directions)
    # A small turn w about the origin moves a point p along n by (p x n) w.
    by_turns = np.cross(points[numbers], directions)
    return np.hstack([by_modes, by_turns, directions])


def _nearest_surface_points(
    points: Floats64, triangles: Integers32, asked: Integers32, surface: HeadMesh
) -> tuple[Floats64, Floats64, Floats64]:
    """Nearest point of the surface to each point, its normal, and the cosine between both
    normals.
    """
    own = vertex_normals(points, triangles)[asked]
    at = nearest_on(points[asked], own, surface.vertices, surface.faces)
    facing = at.interpolate(surface.normals)
    facing = unit_vectors(facing)
    cosine = np.clip((facing * own).sum(axis=1), -1.0, 1.0)
    return at.interpolate(surface.vertices), facing, cosine


def report(found: Mapping[str, Remainder]) -> str:
    """The text to print."""
    columns = "|".join(f"{name} mm:9.2f|degrees:7.1f" for name in found)
    rows = [
        (
            region,
            *(x for each in found.values() for x in (each.distances[region], each.angles[region])),
        )
        for region in (*REGION_NAMES, "all")
    ]
    lines = [
        "Distance of the head from the nearest person: RMS along its normals [mm] and median angle",
        "between normals, of its own mesh and of the finest one.",
        "",
        *table(f"region:<9|{columns}", rows),
        "",
    ]
    for name, each in found.items():
        rms = root_mean_square(each.weights)
        largest = np.abs(each.weights).max()
        lines.append(
            f"weights, {name}: rms {rms:.2f}, largest {largest:.1f}; people have 1 and 2.5"
        )
    return "\n".join(lines)


def targets(found: Mapping[str, Remainder]) -> list[Target]:
    """The bounds that the form of a head must keep."""
    fine = found["finer"]
    limits = MOST_DISTANCES.items()
    most_angle = 5.0  # [deg] of the finer mesh
    most_coarse = 0.80  # [mm] of the coarse mesh
    return [
        *(at_most(f"finer, {n}", fine.distances[n], most, " mm") for n, most in limits),
        at_most("finer, angle", fine.angles["all"], most_angle, " degrees"),
        at_most("coarse, all", found["coarse"].distances["all"], most_coarse, " mm"),
    ]
