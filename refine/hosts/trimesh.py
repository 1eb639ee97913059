"""Meshes of trimesh, refined frame by frame: a mesh comes in, and goes back as one.

https://trimesh.org/trimesh.base.html has the attributes that are read. trimesh is not imported.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from ..border.plugin import View
from .welded import WeldedRefiner


class TrimeshRefiner(WeldedRefiner):
    """Refines a `trimesh.Trimesh` in motion; `from_trimesh` makes it."""

    def __init__(self, mesh: Any, *, weld: bool = True, **options: Any) -> None:
        """Bind to a mesh at rest; see `from_trimesh`."""
        bases: list[Any] = [base for base in type(mesh).__mro__ if base.__name__ == "Trimesh"]
        if not bases:
            raise ValueError(
                f"mesh must be a trimesh.Trimesh, got {type(mesh).__name__}; of a scene take one "
                "mesh, as in list(scene.geometry.values())[0], or all joined, scene.to_mesh()"
            )
        self._type = bases[0]  # a primitive is one, too, but cannot be made of triangles
        self._rest = mesh.copy()
        super().__init__(mesh.vertices, mesh.faces, weld=weld, seams=_has_data(mesh), **options)

    def as_trimesh(self, frame: Any, view: View | None = None) -> Any:
        """Refine one frame; return it as a `trimesh.Trimesh` of its own.

        `frame`: vertices, shape (V, 3), which carry the data of the mesh at rest; or a mesh of
        trimesh with those vertices, which brings its own. Texture coordinates with their material,
        colours, and attributes of vertices and faces go along. The mesh is made with
        `process=False`, because merging vertices would drop their normals.
        """
        given = frame if isinstance(frame, self._type) else self._rest
        mesh = self.refine(frame.vertices if given is frame else frame, view=view)
        return self._type(
            vertices=mesh.positions.copy(),
            faces=mesh.triangles.astype(np.int64),
            vertex_normals=mesh.normals.copy(),
            visual=self._visual(given.visual, mesh.source),
            vertex_attributes={k: self.carry(v) for k, v in given.vertex_attributes.items()},
            face_attributes={
                k: np.asarray(v)[mesh.source] for k, v in given.face_attributes.items()
            },
            metadata=given.metadata.copy(),
            process=False,
        )

    def _visual(self, visual: Any, source: npt.NDArray[np.int32]) -> Any:
        """What a mesh of trimesh looks like, on the triangles of the frame."""
        kind = visual.kind
        if kind == "texture" and visual.uv is not None:
            return type(visual)(uv=self.carry(visual.uv), material=visual.material)
        if kind == "vertex":
            return type(visual)(vertex_colors=self.carry(visual.vertex_colors))
        if kind == "face":
            return type(visual)(face_colors=visual.face_colors[source])
        return None


def from_trimesh(mesh: Any, *, weld: bool = True, **options: Any) -> TrimeshRefiner:
    """Bind a refiner to a `trimesh.Trimesh` at rest, textured or not.

        refiner = refine.from_trimesh(mesh)
        for vertices in motion:
            frame = refiner.as_trimesh(vertices)      # or refiner.refine(vertices): arrays alone

    trimesh has vertices twice where texture coordinates or normals differ. They are welded, so that
    no crack opens, and part again where the mesh carries data. `weld=False` leaves vertices at
    equal places apart, for lips that touch at rest. `options`: what `create_kahler` takes; unless
    told otherwise `scheme="cubic", criterion="displacement+rest"`, which rounds a mesh at rest,
    too.

    Raises ValueError for anything else than a mesh of trimesh, and for what cannot be bound.
    """
    return TrimeshRefiner(mesh, weld=weld, **options)


def _has_data(mesh: Any) -> bool:
    """Whether vertices of a mesh carry anything that may differ at one place."""
    return mesh.visual.kind in ("texture", "vertex") or bool(mesh.vertex_attributes)
