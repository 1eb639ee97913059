"""What refinement does for the cloth, beside a cloth that was simulated with four times as many
triangles, of which the coarse one keeps every second vertex each way.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from risorius import assets, refine, sim
from risorius.app.capture.drawing import camera_for
from risorius.app.files import Image
from risorius.app.refining.presets import FIRST_PRESET, PRESETS
from risorius.app.scenes import ClothScene
from risorius.assets.sheets import CLOTH_CELL, CLOTH_CELLS, make_grid
from risorius.bench.canvas import FLAT, GOURAUD, Canvas, Drawing
from risorius.bench.reproduce.figure_9 import levels_apart, outline_apart

SMOOTH = PRESETS[FIRST_PRESET]["cloth"].told("kahler")


@pytest.fixture(scope="module")
def pictures() -> dict[str, Image]:
    """Flat shaded: the coarse cloth static, by the paper's rule, in the first look; and dense."""
    cloth = assets.load("cloth")
    flat, faces = make_grid(2 * CLOTH_CELLS, 2 * CLOTH_CELLS, CLOTH_CELL / 2)
    sheet = SimpleNamespace(vertices=flat[:, [1, 2, 0]] + [0, cloth.vertices[0, 1], 0], faces=faces)
    dense = sim.Cloth(sheet, np.zeros(3), cloth.radius)
    dense.held = 0.0
    dense.step(4.0)
    side = 2 * CLOTH_CELLS + 1
    coarse = dense.positions.reshape(side, side, 3)[::2, ::2].reshape(-1, 3)
    scene = ClothScene()
    camera = camera_for(scene, "24,12,1.8")
    with Canvas((480, 400)) as canvas:
        truth = refine.create("none", faces, sheet.vertices)
        images = {"dense": canvas.draw_image(truth, dense.positions, Drawing(camera, GOURAUD))}
        looks = {"static": ("none", {}), "paper": ("kahler", {}), "smooth": ("kahler", SMOOTH)}
        for name, (refiner_name, options) in looks.items():
            refiner = refine.create(refiner_name, cloth.faces, cloth.vertices, **options)
            images[name] = canvas.draw_image(refiner, coarse, Drawing(camera, FLAT))
    return images


def test_the_effect_is_plain(pictures: dict[str, Image]) -> None:
    """A third of the cloth and more changes by more than 8 levels."""
    changed = np.abs(pictures["paper"].astype(int) - pictures["static"]).max(axis=2) > 8
    shown = pictures["static"].mean(axis=2) < 250
    assert changed[shown].mean() > 0.35


@pytest.mark.parametrize("look", ["paper", "smooth"])
def test_it_goes_toward_the_dense_cloth(pictures: dict[str, Image], look: str) -> None:
    """Flat shaded, what is refined is nearer to the dense cloth by a seventh and more."""
    off = {name: levels_apart(image, pictures["dense"]) for name, image in pictures.items()}
    assert off[look] < 0.85 * off["static"]


def test_curves_mend_the_outline(pictures: dict[str, Image]) -> None:
    """By half and more."""
    off = {name: outline_apart(image, pictures["dense"]) for name, image in pictures.items()}
    assert off["smooth"] < 0.6 * off["static"]
