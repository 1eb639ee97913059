"""A clip: a scene's motion in all frames of a script, for the writers of files.

Lengths are millimetres. Axes are the scene's axes (x toward the subject's left, y up, z forward).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from risorius import refine
from risorius.geometry.arrays import Floats32, Floats64, Integers32

from ..errors import UserError
from ..motion import play, scene_of
from ..refining.plug_ins import plug_ins_of, reported
from ..refining.presets import Refinement
from ..refining.refiners import Splits, refiner_for
from ..rig.surface import MovingSurface
from ..scenes import Scene
from ..script import Script


@dataclass(frozen=True)
class Clip:
    """A scene in N frames.

    surfaces: the skin, or the only mesh of a scene, comes first.
    bones: name, such as "cranium" or "eye_left", -> matrix of the bone in each frame, (N, 4, 4).
    controls: name of a control -> its set value in each frame, shape (N,).
    activations: name of a muscle, jaw or gaze control -> sum of all controls that move it, shape
        (N,); {} without muscles.
    """

    scene: Scene
    script: Script
    frames_per_second: float
    surfaces: tuple[MovingSurface, ...]
    bones: Mapping[str, Floats64]
    controls: Mapping[str, Floats64]
    activations: Mapping[str, Floats64]

    @property
    def skin(self) -> MovingSurface:
        """The simulated mesh."""
        return self.surfaces[0]

    @property
    def frame_count(self) -> int:
        """The number N of frames."""
        assert self.skin.shapes is not None
        return len(self.skin.shapes)

    @cached_property
    def times(self) -> Floats64:
        """The times of the frames [s], shape (N,)."""
        return np.arange(self.frame_count) / self.frames_per_second

    def refiner(self, refinement: Refinement, splits: Splits | None = None) -> refine.Refiner:
        """Make a refiner of the skin. splits: fixed number for each edge, (E,), or None."""
        return refiner_for(self.scene, refinement, splits)

    def refined(
        self, refinement: Refinement, refiner: refine.Refiner | None = None
    ) -> Iterator[refine.RefinedMesh]:
        """Yield the refined skin of each frame in order; the next frame overwrites its arrays.

        refiner: a result of `refiner`, None for a new refiner. Raises UserError for a refiner that
        needs a viewpoint, and PlugInError if code of another package fails.
        """
        refiner = self.refiner(refinement) if refiner is None else refiner
        plug_ins = plug_ins_of(*refinement.for_scene(self.scene.name))
        for frame in range(self.frame_count):
            try:
                with reported(plug_ins):
                    mesh = refiner.refine(self.skin.at(frame))
            except ValueError as error:
                raise UserError(
                    f"refiner {refinement.for_scene(self.scene.name)[0]}: {error}"
                ) from None
            yield mesh


def record(
    script: Script,
    scene: Scene | None = None,
    frames_per_second: float = 30.0,
    *,
    span: tuple[float, float] | None = None,
    progress: bool = True,
) -> Clip:
    """Play a script on its scene (built if None), and record all frames, or frames in `span` [s].

    Raises UserError if the scene lacks a control of the script.
    """
    scene = scene_of(script) if scene is None else scene
    begin, end = span or (0.0, script.duration)
    most = round(end * frames_per_second) + 1
    positions = np.empty((most, *scene.positions.shape), np.float32)
    bones: list[Mapping[str, Floats64]] = []
    shapes: list[list[Floats32]] = [[] for _ in scene.exported_parts]
    moved = None if scene.face is None else scene.face.simulation.controls
    controls = list[Floats64]()
    activations = list[Floats64]()
    for now in play(scene, script, frames_per_second, until=end, progress=progress):
        if now < begin - 0.5 / frames_per_second:
            continue
        positions[len(bones)] = scene.positions
        bones.append({name: np.array(each) for name, each in scene.bone_transforms().items()})
        for kept, part in zip(shapes, scene.exported_parts, strict=True):
            kept.append(part.vertices)
        controls.append(scene.values.numbers)
        activations.append(np.array([] if moved is None else moved.wanted))
    matrices = {name: np.stack([each[name] for each in bones]) for name in bones[0]}
    skin = MovingSurface(
        "skin" if moved else scene.name,
        scene.rest_positions,
        scene.faces,
        positions[: len(bones)],
        uv=scene.skin.uv,
        face_uv=scene.skin.face_uv,
    )
    both = zip(scene.exported_parts, shapes, strict=True)
    parts = [_surface_of(*each, matrices) for each in both]
    return Clip(
        scene=scene,
        script=script,
        frames_per_second=frames_per_second,
        surfaces=(skin, *parts),
        bones=matrices,
        controls=dict(zip(scene.values, np.stack(controls, axis=1), strict=True)),
        activations=dict(
            zip(moved.lowest if moved else (), np.stack(activations, axis=1), strict=True)
        ),
    )


def _surface_of(
    part: Any, shapes: list[Floats32], matrices: Mapping[str, Floats64]
) -> MovingSurface:
    """Make the surface of a part.

    shapes: its vertices in each frame; a new array if they have changed.
    """
    is_rigid = all(each is shapes[0] for each in shapes)
    return MovingSurface(
        name=part.name,
        rest=shapes[0].astype(np.float64),
        faces=part.faces,
        shapes=None if is_rigid else np.stack(shapes),
        matrices=matrices[part.bone],
        colours=part.colours,
        shine=part.shine,
    )


@dataclass(frozen=True)
class FrameSurface:
    """One surface in one frame [mm], in the form of mesh files.

    points, normals: positions and normals of vertices, shape (V, 3). faces: shape (F, 3). uv,
    face_uv: as in `MovingSurface`, None without a texture. source: the triangle of the surface that
    contains each triangle, shape (F,).
    """

    points: Floats64
    normals: Floats64
    faces: Integers32
    uv: Floats32 | None
    face_uv: Integers32 | None
    source: Integers32


def frame_surfaces(
    clip: Clip, refinement: Refinement | None = None
) -> Iterator[list[FrameSurface]]:
    """Yield all surfaces of each frame; the skin comes first, and is refined on request."""
    skins = None if refinement is None else _refined(clip, refinement)
    for frame in range(clip.frame_count):
        skin = None if skins is None else next(skins)
        plain = clip.surfaces if skin is None else clip.surfaces[1:]
        rest = [_unrefined(each, frame) for each in plain]
        yield rest if skin is None else [skin, *rest]


def _unrefined(surface: MovingSurface, frame: int) -> FrameSurface:
    """Return an unrefined surface in a frame."""
    points = surface.at(frame)
    return FrameSurface(
        points=points,
        normals=surface.normals_of(points, frame),
        faces=surface.faces,
        uv=surface.uv,
        face_uv=surface.face_uv,
        source=surface.source,
    )


def _refined(clip: Clip, refinement: Refinement) -> Iterator[FrameSurface]:
    """Yield the refined skin of each frame, in new arrays."""
    for mesh in clip.refined(refinement):
        faces = mesh.triangles.astype(np.int32)
        yield FrameSurface(
            points=mesh.positions.astype(np.float64),
            normals=mesh.normals.astype(np.float64),
            faces=faces,
            uv=None if mesh.uv is None else mesh.uv.copy(),
            face_uv=None if mesh.uv is None else faces,
            source=mesh.source.copy(),
        )
