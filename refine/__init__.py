"""Dynamic refinement of animated triangle meshes: arrays in, crack-free triangles out, each frame.

After Kähler, Haber and Seidel, "Dynamically refining animated triangle meshes for rendering", The
Visual Computer 2003. It needs numpy, numba, and the modules jit.py and geometry/ beside this
folder.

    refiner = refine.create("kahler", faces, rest_positions)   # once per mesh
    mesh = refiner.refine(positions)                           # every frame
    draw(mesh.positions, mesh.normals, mesh.triangles)

Refiners by name: `none` returns the mesh itself, `kahler` is the paper's, `loop` subdivides the
whole mesh for comparison. `refine(positions, out=stream)` writes straight into the caller's arrays.
`Shortening` measures how far the skin is compressed. `Embedding` carries a fine mesh with a coarse
one. `check` and `check_embedding` are for tests: they raise an error that names the broken
relation.

`kahler` follows the paper by default. Its options: `scheme` places points, `criterion` chooses the
split edges, `splits` fixes them for all frames, `blend` keeps points from popping, `coherent` keeps
existing diagonals when a further edge splits, `attributes` are further values at vertices,
`crease_angle` keeps edges sharp. Schemes, criteria and refiners of other authors join by name:
`schemes.register`, `criteria.register`, `refiners.register`, or an entry point. They derive from
`Scheme`, `Criterion` and `BaseRefiner`.

There is one subfolder or module for each subject. Each may import from those above it in this list,
and from jit.py (the compiler) and geometry/ beside this folder:

    mesh/       the bound mesh: connectivity, seams, normals
    border/     input and output of every refiner; the protocol is plugin.py
    kahler/     the paper: refiner.py is a frame, then sections 4.1 to 4.4, one file each
    beyond/     its options (options.py), other criteria and schemes, blending
    others.py   refiners to compare with
    strain.py   how far the skin is shortened
    embedding/  a fine mesh that follows the smooth surface of a coarse one
    hosts.py    meshes as other programs keep them
    port.py     tables and rules, for authors who port the method

Read border/plugin.py first, then kahler/. docs/refinement.md shows it with pictures.
"""

from .beyond.blending import Blended
from .beyond.cubic import CubicScheme
from .beyond.curvature import RestCurvature
from .beyond.detail import DetailScheme
from .beyond.displacement import Displacement
from .beyond.measuring import Maximum, Silhouette
from .beyond.options import create_kahler
from .border.base import BaseRefiner
from .border.checker import BrokenMeshError, check
from .border.corner_values import Values
from .border.option import Option
from .border.plugin import GpuRefiner, GpuStream, Origins, RefinedMesh, Refiner, Stream, View
from .border.registry import Registry, create, parameters, refiners, takes_attributes
from .border.stream import StreamArrays
from .embedding.checker import check_embedding
from .embedding.embedding import Binding, EmbeddedPoints, Embedding
from .hosts import WeldedRefiner
from .kahler.coherence import Coherent
from .kahler.criterion import (
    THRESHOLD_ONCE,
    THRESHOLD_TWICE,
    Criterion,
    NormalDrop,
    Thresholds,
    criteria,
)
from .kahler.cutting import Cutting
from .kahler.frame import FrameBuffers
from .kahler.given_splits import splits_of_clip
from .kahler.refiner import Kahler
from .kahler.scheme import Scheme, schemes
from .kahler.smoothing import LoopScheme
from .mesh.connectivity import Connectivity, connect
from .mesh.seams import weld
from .others import Loop, PassThrough
from .strain import Shortening

__all__ = [
    "THRESHOLD_ONCE",
    "THRESHOLD_TWICE",
    "BaseRefiner",
    "Binding",
    "Blended",
    "BrokenMeshError",
    "Coherent",
    "Connectivity",
    "Criterion",
    "CubicScheme",
    "Cutting",
    "DetailScheme",
    "Displacement",
    "EmbeddedPoints",
    "Embedding",
    "FrameBuffers",
    "GpuRefiner",
    "GpuStream",
    "Kahler",
    "Loop",
    "Maximum",
    "NormalDrop",
    "Option",
    "Origins",
    "PassThrough",
    "RefinedMesh",
    "Refiner",
    "Registry",
    "RestCurvature",
    "Scheme",
    "Shortening",
    "Silhouette",
    "Stream",
    "StreamArrays",
    "Thresholds",
    "Values",
    "View",
    "WeldedRefiner",
    "check",
    "check_embedding",
    "connect",
    "create",
    "create_kahler",
    "criteria",
    "parameters",
    "refiners",
    "schemes",
    "splits_of_clip",
    "takes_attributes",
    "weld",
]

refiners.register("kahler", create_kahler)
refiners.register("loop", Loop)
refiners.register("none", PassThrough)
criteria.register("normal", NormalDrop)
criteria.register("rest", RestCurvature)
criteria.register("displacement", Displacement)
criteria.register("silhouette", Silhouette)
schemes.register("loop", LoopScheme)
schemes.register("cubic", CubicScheme)
schemes.register("detail", DetailScheme)
