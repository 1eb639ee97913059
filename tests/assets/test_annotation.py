"""Where annotators put points: on what a picture shows."""

import numpy as np
import pytest

from risorius.assets.annotation import _on_texture, annotation_of
from risorius.assets.identities import complexion, person_called


@pytest.mark.slow
@pytest.mark.parametrize("number", [3, 8, 21])
def test_points_of_brows_lie_on_hairs_that_are_seen(monkeypatch, number):
    """The tail's within 1.5 mm of the last one, whatever way it turns; none above those in front.

    In front a few hairs stand out of the brow, which nobody marks.
    """
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
    seen = 0.3  # of the darkness of a hair
    rows, columns = np.nonzero(hairs > seen)
    uv = (np.column_stack([columns, rows]) + 0.5) / len(hairs) * [1.0, -1.0] + [0.0, 1.0]
    places = _on_texture(uv[columns > len(hairs) / 2]).interpolate(person.vertices)
    nose_end, tail = points[[22 - 17, 26 - 17]]
    last = places[np.linalg.norm(places - nose_end, axis=1).argmax()]
    assert np.linalg.norm(tail - last) < 1.5  # mm
    front = points[23 - 17]
    beside = places[np.abs(places[:, 0] - front[0]) < 0.5]
    assert -2.5 < front[1] - beside[:, 1].max() < 0.4  # mm
