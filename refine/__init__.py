"""Dynamic refinement of animated triangle meshes: arrays in, crack-free triangles out, each frame.

After Kähler, Haber and Seidel, "Dynamically refining animated triangle meshes for rendering", The
Visual Computer 2003. The package stands alone: it needs numpy and numba and nothing else.

    refiner = refine.create("kahler", faces, rest_positions)   # once per mesh
    mesh = refiner.refine(positions)                           # every frame
    draw(mesh.positions, mesh.normals, mesh.triangles)

Refiners by name: `none` hands the mesh through, `kahler` is the paper's, `loop` subdivides the
whole mesh once or twice for comparison. `refine(positions, out=stream)` writes straight into lent
arrays. `Tension` measures how far the skin is stretched. `check` is for tests: it names the
relation that a refined mesh breaks.

`kahler` does what the paper says unless it is told otherwise: `scheme` says where points go,
`criterion` which edges are split, `blend` that nothing pops, `coherent` that no triangulation
turns, `attributes` what rides along.

Read in this order: plugin.py (the border), adaptive.py (a frame) and frame.py (what its passes hand
on), criterion.py, criteria.py and rest_curvature.py (which edges), schemes.py (where points go:
masks.py, cubic.py, detail.py), blend.py, patterns.py and coherence.py (the tables), output.py (rows
and triangles), jit.py (how all this is compiled). docs/refinement.md tells it all with pictures.
"""

from .adaptive import Kahler
from .checker import BrokenMeshError, check
from .coherence_pass import Coherent
from .connectivity import Connectivity, connect, weld
from .criteria import Bulge, Curvature, Maximum, ScreenEdge, Silhouette
from .criterion import THRESHOLD_ONCE, THRESHOLD_TWICE, Criterion, Measured, NormalDrop
from .frame import Frame
from .passthrough import PassThrough
from .plugin import Origins, RefinedMesh, Refiner, Stream, View, available, create, register
from .reorder import Order, reorder
from .rest_curvature import RestCurvature
from .schemes import Scheme
from .shortening import Shortening
from .tension import Tension, TensionMap
from .uniform import Loop

__all__ = [
    "THRESHOLD_ONCE",
    "THRESHOLD_TWICE",
    "BrokenMeshError",
    "Bulge",
    "Coherent",
    "Connectivity",
    "Criterion",
    "Curvature",
    "Frame",
    "Kahler",
    "Loop",
    "Maximum",
    "Measured",
    "NormalDrop",
    "Order",
    "Origins",
    "PassThrough",
    "RefinedMesh",
    "Refiner",
    "RestCurvature",
    "Scheme",
    "ScreenEdge",
    "Shortening",
    "Silhouette",
    "Stream",
    "Tension",
    "TensionMap",
    "View",
    "available",
    "check",
    "connect",
    "create",
    "register",
    "reorder",
    "weld",
]

register("none", PassThrough)
register("kahler", Kahler)
register("loop", Loop)
