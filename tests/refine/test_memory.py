"""The memory of a refiner is freed with it."""

import gc
import subprocess
import sys
import weakref

import numpy as np
import pytest

from risorius import refine
from tests import meshes

OPTIONS_OF_LOOKS = {
    "paper": {},
    "coherent": {"coherent": True},
    "blended": {"blend": True},
    "window": {"scheme": "cubic", "criterion": "displacement+rest"},
    "eye": {"scheme": "cubic", "criterion": "silhouette+rest+normal"},
    "refined normals": {"normals": "refined", "criterion": "displacement"},
}
EYE = refine.View([50.0, 50.0, 90.0])
MANY_PROGRAM = """
import resource
import sys

import numpy as np

from risorius import refine
from risorius.assets.sheets import make_grid
from tests.refine.test_memory import EYE, OPTIONS_OF_LOOKS

rest, faces = make_grid(100, 100, 1.0)
bent = rest + 0.3 * np.sin(rest[:, [1, 2, 0]])
peaks = []
for count in (5, 100):
    for _ in range(count):
        refine.create("kahler", faces, rest, **OPTIONS_OF_LOOKS[sys.argv[1]]).refine(bent, view=EYE)
    peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
print(peaks[1] - peaks[0])
"""


@pytest.mark.parametrize("look", OPTIONS_OF_LOOKS)
def test_arrays_go_with_their_refiner(look):
    """Compiled code keeps no reference to its arguments, nor to lent arrays."""
    mesh = meshes.irregular(5)
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, **OPTIONS_OF_LOOKS[look])
    assert isinstance(refiner, refine.Kahler)
    lent = refine.StreamArrays(
        np.zeros((refiner.vertex_capacity, refiner.vertex_columns), np.float32),
        np.zeros((refiner.triangle_capacity, 3), np.uint32),
        np.zeros(refiner.triangle_capacity, np.int32),
    )
    for stream in (None, lent, None):
        refiner.refine(meshes.wrinkled(mesh, 6), out=stream, view=EYE)
    held = [refiner.positions, refiner.points, refiner.normals, *lent]
    groups = [each for each in vars(refiner).values() if isinstance(each, tuple)]
    held += [array for group in groups for array in group if isinstance(array, np.ndarray)]
    alive = [weakref.ref(array) for array in held]
    del refiner, lent, held, groups, stream
    gc.collect()
    assert [reference() for reference in alive if reference() is not None] == []


@pytest.mark.slow
@pytest.mark.parametrize("look", OPTIONS_OF_LOOKS)
def test_a_hundred_refiners_take_the_memory_of_one(look):
    """A hundred refiners, deleted after a frame, leave less than 5 MB.

    Each is made for 20 000 triangles.
    """
    pytest.importorskip("resource", reason="measures the memory of a process; not on Windows")
    call = [sys.executable, "-c", MANY_PROGRAM, look]
    found = subprocess.run(call, capture_output=True, text=True, check=True)
    units = 2**20 if sys.platform == "darwin" else 2**10  # units of ru_maxrss per megabyte
    assert int(found.stdout) / units < 5.0
