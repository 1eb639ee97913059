"""Annotated points are placed on visible features of a picture."""

import numpy as np
import pytest
from numpy.linalg import norm

from risorius.assets.annotation import annotation_of, points_on_texture
from risorius.assets.identities import complexion, person_called


@pytest.mark.slow
@pytest.mark.parametrize("number", [3, 8, 21])
def test_a_brow_ends_where_its_hairs_do(monkeypatch, number):
    """The landmark at a brow's tail is within 1.5 mm of the last visible hair, for any tail."""
    painted = complexion.painted
    pictures = []

    def kept(brows, size):
        pictures.append(painted(brows, size))
        return pictures[-1]

    monkeypatch.setattr(complexion, "painted", kept)
    person = person_called(number)
    assert person.segments is not None
    hairs = pictures[-1]
    points = annotation_of(person).inner_points(person.vertices)
    seen = 0.3  # share of a hair's darkness
    rows, columns = np.nonzero(hairs > seen)
    uv = (np.column_stack([columns, rows]) + 0.5) / len(hairs) * [1.0, -1.0] + [0.0, 1.0]
    places = points_on_texture(uv[columns > len(hairs) / 2]).interpolate(person.vertices)
    nose_end, tail = points[[22 - 17, 26 - 17]]
    last = places[norm(places - nose_end, axis=1).argmax()]
    assert norm(tail - last) < 1.5  # [mm]
