"""A scene's mesh, refined by one refiner into buffers of the renderer.

The refiner reads the mesh and writes only into these buffers. The refined mesh is forgotten with
the frame (Kähler, Haber, Seidel 2003, section 3). Buffers and refiner may be on the graphics card;
other modules need not know that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from risorius import refine, render
from risorius.geometry.arrays import Floats64, Unsigned8
from risorius.geometry.sides import side_lengths

from ..scenes import Drawable
from .plug_ins import PlugIn, plug_ins_of, reported
from .presets import CARD_REFINER, Refinement
from .refiners import refiner_for
from .wrinkling import GRADIENT_ATTRIBUTE, WRINKLE_ATTRIBUTE, Wrinkling

FADE_ATTRIBUTE = "fade"  # an attribute of refined meshes
LARGE_MESH = 20_000  # triangles; by default the graphics card refines meshes of this size


@dataclass
class DrawnMesh:
    """The scene's mesh with one refiner; two objects make a comparison."""

    label: str  # its name under the picture
    refiner: refine.Refiner
    stream: render.Stream | render.GpuStream
    mesh: refine.RefinedMesh | None = None  # the last result
    positions: Floats64 | None = None  # the positions from which it was refined
    plug_ins: tuple[PlugIn, ...] = ()  # code of other packages in the refiner
    wrinkles: bool = False  # whether the last frame has wrinkles
    resting: Callable[[], refine.Refiner] | None = None  # makes an equal refiner, refined at rest
    _splits_at_rest: Unsigned8 | None = None  # for each edge, shape (E,)

    def refine(
        self,
        positions: Floats64,
        camera: render.OrbitCamera,
        wrinkling: Wrinkling | None = None,
    ) -> None:
        """Fill the lent buffers with refined triangles for a camera.

        `wrinkling`: wrinkles of the skin. Raises PlugInError if code of another package fails.
        """
        view = refine.View(camera.eye)
        self.positions = positions
        more = {}
        self.wrinkles = False
        if self.can_wrinkle and wrinkling is not None:
            more["values"] = {
                WRINKLE_ATTRIBUTE: wrinkling.amounts,
                GRADIENT_ATTRIBUTE: wrinkling.gradients,
            }
            self.wrinkles = bool(wrinkling.amounts.any())
        refiner: Any = self.refiner  # a refiner without attributes may lack `values`
        with reported(self.plug_ins):
            if isinstance(self.stream, render.GpuStream):
                self.mesh = refiner.refine_on_card(positions, self.stream, view, **more)
            else:
                self.mesh = refiner.refine(positions, self.stream, view, **more)

    def upload(self) -> None:
        """Upload the last refined mesh."""
        assert self.mesh is not None and self.positions is not None
        with reported(self.plug_ins):
            if isinstance(self.stream, render.GpuStream):
                mesh: Any = self.mesh  # a refiner may fetch rows on demand
                self.stream.show(mesh, self.positions, has_bumps=self.wrinkles)
            else:
                counts = self.mesh.vertex_count, self.mesh.triangle_count
                self.stream.upload(*counts, has_bumps=self.wrinkles)

    def splits(self) -> Unsigned8:
        """Return for each drawn triangle the number of splits of its source triangle's edges."""
        assert self.mesh is not None
        with reported(self.plug_ins):
            return splits_of_source(self.refiner, self.mesh)

    def splits_beyond_rest(self) -> Unsigned8:
        """Return the same as `splits`, minus the splits that these edges have at rest."""
        assert self.mesh is not None and self.resting is not None
        with reported(self.plug_ins):
            if self._splits_at_rest is None:
                self._splits_at_rest = self.resting().splits.copy()
            added = np.maximum(self.refiner.splits, self._splits_at_rest) - self._splits_at_rest
            of_triangles = added[self.refiner.triangle_edges].sum(axis=1, dtype=np.uint8)
            return np.take(of_triangles, self.mesh.source)

    @property
    def has_uv(self) -> bool:
        """Whether vertices have texture coordinates; other packages' refiners may lack them."""
        # Position, normal, u and v.
        return self.refiner.vertex_columns >= 8

    @property
    def can_wrinkle(self) -> bool:
        """Whether vertices have wrinkles."""
        return self.refiner.vertex_columns >= 16

    @property
    def can_fade(self) -> bool:
        """Whether vertices have the fading of the skin."""
        return self.refiner.vertex_columns == 18

    @property
    def triangle_count(self) -> int:
        """Number of triangles in the last frame."""
        return self.stream.triangle_count

    @property
    def caption(self) -> str:
        """The text under the picture: the name and the number of triangles."""
        return f"{self.label}\n{self.triangle_count} triangles"


def bind(scene: Drawable, renderer: render.Renderer, refinement: Refinement) -> DrawnMesh:
    """Bind the requested refiner to the scene's mesh, with buffers of the renderer.

    A large mesh with an unchanged look is refined on the graphics card, with the same result.
    """
    has_card = renderer.lends_gpu_streams and not renderer.surface.is_software
    is_plain_look = refinement.refiner is None and not refinement.options
    suits_card = has_card and is_plain_look and len(scene.faces) >= LARGE_MESH
    chosen = replace(refinement, refiner=CARD_REFINER) if suits_card else refinement
    refiner = refiner_for(scene, chosen, attributes=_attributes_of(scene))
    plug_ins = plug_ins_of(*chosen.for_scene(scene.name))
    with reported(plug_ins):
        stream = _stream_for(scene, renderer, refiner)

    def resting() -> refine.Refiner:
        """Make a separate refiner, because some refiners depend on the frame before."""
        twin = refiner_for(scene, chosen)
        twin.refine(scene.rest_positions)
        return twin

    return DrawnMesh(refinement.label, refiner, stream, plug_ins=plug_ins, resting=resting)


def _attributes_of(scene: Drawable) -> dict[str, Any]:
    """Return further attributes of vertices: wrinkles and fading, if the scene has wrinkles."""
    skin = scene.skin
    if skin.wrinkles is None or skin.uv is None:
        return {}
    amounts = np.zeros((len(scene.rest_positions), 2), np.float32)
    gradients = np.zeros((len(skin.uv), 6), np.float32)
    attributes: dict[str, Any] = {
        WRINKLE_ATTRIBUTE: amounts,
        GRADIENT_ATTRIBUTE: gradients if skin.face_uv is None else (gradients, skin.face_uv),
    }
    return attributes if skin.fade is None else attributes | {FADE_ATTRIBUTE: skin.fade}


def _stream_for(
    scene: Drawable, renderer: render.Renderer, refiner: refine.Refiner
) -> render.Stream | render.GpuStream:
    """Return buffers for a refiner's largest output, in main memory or on the graphics card."""
    room = refiner.vertex_capacity, refiner.triangle_capacity, refiner.vertex_columns
    if not (renderer.lends_gpu_streams and isinstance(refiner, refine.GpuRefiner)):
        return renderer.lend_stream(*room)
    longest = side_lengths(scene.rest_positions, refiner.edges).max(initial=0.0)
    return renderer.lend_gpu_stream(*room, margin=float(longest))


def splits_of_source(refiner: refine.Refiner, mesh: refine.RefinedMesh) -> Unsigned8:
    """Return for each drawn triangle the number of splits of its source triangle's edges."""
    splits: Unsigned8 = refiner.splits[refiner.triangle_edges].sum(axis=1, dtype=np.uint8)
    return np.take(splits, mesh.source)
