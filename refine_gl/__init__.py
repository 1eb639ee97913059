"""The paper's refiner on the graphics card: the refiner `kahler-gl`, to the bits of `kahler`.

Kähler, Haber, Seidel, "Dynamically refining animated triangle meshes for rendering", The Visual
Computer 2003. Positions go up in every frame, six passes of compute shaders turn them into
triangles in the memory that is drawn, and nothing comes back unless a caller reads it.

    refiner = refine.create("kahler-gl", faces, rest_positions)
    mesh = refiner.refine(positions)          # arrays are fetched when they are read

It joins like any plug-in, by an entry point of the group `risorius.refiners`, and needs
`risorius.refine`, numpy and moderngl. OpenGL 4.3 or newer runs it, in software too. Where there is
none, the log says so once, and the processor does the same by `kahler`.

    tables.py     arrays that are handed over once per mesh
    shaders/      the passes; common.glsl is part of each
    frames.py     buffers, programs, and the order of the passes
    context.py    OpenGL where no caller brings any
    refined.py    the mesh of a frame
    refiner.py    the refiner

docs/refinement_on_the_card.md explains it with a picture, and lists the comparisons.
"""

from .context import LEAST_VERSION, GpuError
from .refiner import KahlerGl, create_kahler_gl

__all__ = ["LEAST_VERSION", "GpuError", "KahlerGl", "create_kahler_gl"]
