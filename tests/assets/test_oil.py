"""The map of oil, which makes skin shine."""

import numpy as np
import pytest

from risorius import assets
from risorius.assets.coarse import coarse_head
from risorius.assets.identities import person_called


def _at(head, oil, vertex):
    """The oil at a vertex, as a fraction of the forehead's."""
    row = head.face_uv[head.faces == vertex][0]
    u, v = head.uv[row]
    size = len(oil)
    row = min(int((1.0 - v) * size), size - 1)
    column = min(int(u * size), size - 1)
    return oil[row, column] / 255.0


@pytest.mark.parametrize("name", ["built-in", "coarse"])
def test_oil_has_the_order_of_measured_sites(head, name):
    """Nose and chin are oilier than cheeks, as Youn and others 2005 measured, and necks hardly."""
    face = head if name == "built-in" else coarse_head()
    oil = assets.oil_of(face)
    marks = face.vertices[face.landmarks]
    cheek = np.linalg.norm(face.vertices - marks[[36, 48, 3]].mean(axis=0), axis=1).argmin()
    low = np.where(face.vertices[:, 1] < marks[8, 1] - 40.0)[0]
    necks = [_at(face, oil, vertex) for vertex in low]
    cheeks = _at(face, oil, cheek)
    assert _at(face, oil, face.landmarks[30]) > 0.9
    assert 0.9 > _at(face, oil, face.landmarks[8]) > cheeks + 0.05
    assert 0.7 > cheeks > 2.0 * max(necks)


def test_stubble_scatters_the_highlight_of_a_chin():
    """Dense stubble takes half of the oil's highlight; dark chins had a white patch on it."""
    person = person_called(126)
    shaved = assets.oil_of(person)
    bristly = assets.oil_of(person, person.stubble)
    chin, nose = person.landmarks[[8, 30]]
    assert _at(person, bristly, chin) < 0.5 * _at(person, shaved, chin)
    assert _at(person, bristly, nose) == _at(person, shaved, nose)
    assert person_called(11).stubble is None  # a woman


def test_stubble_grows_on_upper_lips():
    """Stubble between nose and lips is half as dense as on the chin; beards had no moustache."""
    person = person_called(126)
    nose, lip, chin = (
        person.uv[person.face_uv[person.faces == vertex][0]]
        for vertex in person.landmarks[[33, 51, 8]]
    )
    size = len(person.stubble)
    (above, below), columns = (size * np.array([nose, lip])).astype(int).T[::-1]
    band = person.stubble[size - above - 1 : size - below, columns[0] - 1 : columns[0] + 1]
    column, row = (size * chin).astype(int)
    assert band.max() > 0.5 * person.stubble[size - 1 - row, column]
