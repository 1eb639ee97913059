"""The paper's refiner on the graphics card, `kahler-gl`; its results equal those of `kahler`.

Kähler, Haber, Seidel, "Dynamically refining animated triangle meshes for rendering", The Visual
Computer 2003. Positions are uploaded in every frame, and six passes of compute shaders turn them
into triangles in the memory that is drawn. Triangles equal those of `kahler` to the last bit.
Nothing is read back unless a caller reads it.

    refiner = refine.create("kahler-gl", faces, rest_positions)
    mesh = refiner.refine(positions)          # arrays are fetched when they are read

It joins like any plug-in, by an entry point of the group `risorius.refiners`, and needs
`risorius.refine`, numpy and moderngl. It needs OpenGL 4.3 or newer, which may be a software driver.
Without it, one warning is logged, and the refiner `kahler` computes the same on the processor.

    tables.py     arrays that are uploaded once per mesh
    shaders/      the passes; common.glsl is part of each
    frames.py     buffers, programs, and the order of the passes
    context.py    OpenGL for callers without a context
    refined.py    the mesh of a frame
    refiner.py    the refiner

docs/refinement_on_the_card.md explains it with a picture, and lists the comparisons.
"""

from .context import LEAST_VERSION, GpuError
from .refiner import KahlerGl, create_kahler_gl

__all__ = ["LEAST_VERSION", "GpuError", "KahlerGl", "create_kahler_gl"]
