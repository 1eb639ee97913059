"""Refines the skin of a clip into one mesh: the same vertices and triangles in every frame.

An edge is split as often as in the frame that splits it most (`refine.splits_of_clip`). So the mesh
is adaptive, and nowhere coarser than a frame that is refined separately.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.normals import vertex_normals

from ..errors import UserError
from ..refining.plug_ins import plug_ins_of, reported
from ..refining.presets import Refinement
from ..rig.poses import FacePose
from ..rig.surface import RefinedSurface
from .clip import Clip

OriginKeys = npt.NDArray[np.void]


class RefinedSkin:
    """A refined skin as a body of an avatar; each pose is refined anew."""

    name = "skin"

    def __init__(self, surface: RefinedSurface) -> None:
        self.rest: Floats64 = surface.rest
        self.faces: Integers32 = surface.faces
        self._refiner = surface.refiner
        # At seams of texture coordinates, several output vertices have one place.
        rows = np.hstack([surface.rest, surface.rest_normals])
        _, first, same = np.unique(rows, axis=0, return_index=True, return_inverse=True)
        self._same = first[same.ravel()]

    def at(self, pose: FacePose) -> Floats64:
        """Return the vertices in a pose, shape (V, 3)."""
        return self._refiner.refine(pose.skin).positions.astype(np.float64)

    def normals_at(self, points: Floats64) -> Floats64:
        """Return unit normals for vertices at `points`, shape (V, 3) each."""
        joined = self._same[self.faces].astype(np.int32)
        normals: Floats64 = vertex_normals(points, joined)[self._same]
        return normals


@dataclass(frozen=True)
class RefinedClip:
    """A clip with a refined skin, compared with the frames when refined separately.

    clip: a clip whose skin has one topology.
    fewest, most: numbers of triangles of separately refined frames.
    farthest, mean: distances of vertices from the same points of these frames [mm].
    """

    clip: Clip
    fewest: int
    most: int
    farthest: float
    mean: float

    @property
    def words(self) -> str:
        """Describe the refined skin to the user in one line."""
        skin = self.clip.skin
        if self.fewest == self.most == len(skin.faces):
            return f"refined skin of {len(skin.faces)} triangles"
        return (
            f"refined skin of {len(skin.faces)} triangles in all frames; one that changes has "
            f"{self.fewest} to {self.most} and is {self.mean:.3f} mm away on average, "
            f"{self.farthest:.2f} at most"
        )


def with_refined_skin(clip: Clip, refinement: Refinement) -> RefinedClip:
    """Refine the skin of a clip into one mesh that moves.

    Raises UserError for a refiner with changing triangles and no option `splits`, and all errors of
    `Clip.refined`.
    """
    counts = []
    splits = np.zeros(0, np.uint8)
    topologies = set()
    refiner = clip.refiner(refinement)
    for mesh in clip.refined(refinement, refiner):
        counts.append(len(mesh.triangles))
        topologies.add(hash(mesh.triangles.tobytes()))
        splits = refiner.splits if len(counts) == 1 else np.maximum(splits, refiner.splits)
    plug_ins = plug_ins_of(*refinement.for_scene(clip.scene.name))
    with reported(plug_ins):  # triangles at rest may differ from all frames
        at_rest = refiner.refine(clip.scene.rest_positions)
    topologies.add(hash(at_rest.triangles.tobytes()))
    changing = refiner
    if len(topologies) > 1:
        _check_option_splits(refinement.for_scene(clip.scene.name)[0])
        refiner = clip.refiner(refinement, splits)
    with reported(plug_ins):
        rest = deepcopy(refiner.refine(clip.scene.rest_positions))
        origins = refiner.origins()
    shapes = np.empty((clip.frame_count, *rest.positions.shape), np.float32)
    normals = np.empty_like(shapes)
    distances = [np.zeros(1)]
    origin_keys = _origin_keys(origins)
    for frame, mesh in enumerate(clip.refined(refinement, refiner)):
        shapes[frame] = mesh.positions
        normals[frame] = mesh.normals
        if refiner is not changing:
            with reported(plug_ins):
                own = changing.refine(clip.skin.at(frame))
                own_keys = _origin_keys(changing.origins())
            _, ours, theirs = np.intersect1d(origin_keys, own_keys, return_indices=True)
            distances.append(np.linalg.norm(shapes[frame, ours] - own.positions[theirs], axis=1))
    triangles = rest.triangles.astype(np.int32)
    skin = RefinedSurface(
        clip.skin.name,
        rest.positions.astype(np.float64),
        triangles,
        shapes,
        uv=rest.uv,
        face_uv=None if rest.uv is None else triangles,
        rest_normals=rest.normals,
        normals=normals,
        sources=rest.source,
        origins=origins,
        refiner=refiner,
    )
    apart = np.concatenate(distances)
    return RefinedClip(
        clip=replace(clip, surfaces=(skin, *clip.surfaces[1:])),
        fewest=min(counts),
        most=max(counts),
        farthest=float(apart.max()),
        mean=float(apart.mean()),
    )


def _check_option_splits(refiner: str) -> None:
    """Raise UserError if a refiner of this name has no option `splits`."""
    if all(each.name != "splits" for each in refine.parameters(refiner)):
        raise UserError(
            f"--refined: the triangles of refiner {refiner} change, and it has no option splits; "
            "choose another --refiner, or add --changing for USD, OBJ and VTKHDF"
        )


def _origin_keys(origins: refine.Origins) -> OriginKeys:
    """Return each vertex's origin on the mesh as bytes, (N,); equal origins have equal bytes."""
    rows = np.ascontiguousarray(
        np.concatenate([origins.vertices.astype(np.float64), origins.weights], axis=1)
    )
    return rows.view([("", np.void, rows.dtype.itemsize * rows.shape[1])])[:, 0]
