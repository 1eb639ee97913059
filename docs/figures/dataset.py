"""Draw the picture of docs/dataset.md: `python docs/figures/dataset.py [FOLDER]`.

Twenty-four samples of one seed as `risorius dataset` makes them, and six with their labels.
"""

from __future__ import annotations

from pathlib import Path

import figures
import numpy as np
from passes import dotted

from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Shot, Studio
from risorius.app.files import Image

SEED, CELL, COLUMNS, ROWS = 21, 192, 6, 4
LABELLED = (2, 3, 10, 11, 14, 22)  # numbers of samples
EDGE = np.array((255, 255, 255), np.uint8)


def dataset() -> Image:
    """Samples row by row, and below them some of these with landmarks and classes."""
    studio = Studio(request_of(Path(), seed=SEED, size=(CELL, CELL), passes=("segmentation",)))
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
    return dotted(np.where(is_edge[..., None], EDGE, shot.image), shot.known.labels, 1.5)


if __name__ == "__main__":
    figures.run(__doc__, {"dataset": dataset})
