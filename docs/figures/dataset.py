"""Draw the picture of docs/dataset.md: `python docs/figures/dataset.py [FOLDER]`.

Twenty-four samples of one seed as `risorius dataset` makes them, and six with their labels.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import figures
import numpy as np
import PIL.Image
from PIL import ImageDraw

from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Shot, Studio
from risorius.app.files import Image

SEED, CELL, COLUMNS, ROWS = 21, 192, 6, 4
LABELLED = (2, 3, 10, 11, 14, 22)  # numbers of samples
SEEN, HIDDEN, EDGE = (40, 230, 60), (235, 60, 40), (255, 255, 255)


def dataset(cell: int) -> Image:
    """Samples row by row, and below them some of these with landmarks and classes."""
    request = request_of(Path(), seed=SEED, size=(cell, cell), passes=("segmentation",))
    studio = Studio(request)
    shots = [studio.shoot(index) for index in range(COLUMNS * ROWS)]
    images = [shot.image for shot in shots] + [_labelled(shots[index]) for index in LABELLED]
    rows = [np.hstack(images[k : k + COLUMNS]) for k in range(0, len(images), COLUMNS)]
    return np.vstack(rows)


def _labelled(shot: Shot) -> Image:
    """A picture with the borders of its classes, and its landmarks: hidden ones red."""
    classes = shot.known.images["segmentation"]
    is_edge = np.zeros(classes.shape, bool)
    is_edge[1:] |= classes[1:] != classes[:-1]
    is_edge[:, 1:] |= classes[:, 1:] != classes[:, :-1]
    picture = PIL.Image.fromarray(
        np.where(is_edge[..., None], np.array(EDGE, np.uint8), shot.image)
    )
    pen = ImageDraw.Draw(picture)
    landmarks = shot.known.labels["landmarks"]
    for (x, y), is_visible in zip(landmarks["pixels"], landmarks["visible"], strict=True):
        pen.ellipse((x - 1.5, y - 1.5, x + 1.5, y + 1.5), fill=SEEN if is_visible else HIDDEN)
    return np.asarray(picture)


def main(arguments: Sequence[str]) -> None:
    """Draw the picture into the folder given."""
    given = figures.parse(arguments, __doc__, width=CELL)
    every: dict[str, figures.Figure] = {"dataset": partial(dataset, given.width)}
    figures.draw(given.folder, figures.chosen(every, given.only))


if __name__ == "__main__":
    figures.run(main)
