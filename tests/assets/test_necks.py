"""Necks of persons are as even as that of the built-in head."""

import numpy as np
import pytest
import scipy

from risorius.assets import load
from risorius.assets.identities import person_called
from risorius.assets.identities.necks import below_jaw, evened_neck
from risorius.geometry.normals import vertex_normals
from risorius.geometry.sides import edges_of


def heights_over_neighbours(vertices, faces):
    """How far each vertex stands out from the mean of its neighbours, (V,)."""
    links = edges_of(faces)
    both = np.concatenate([links, links[:, ::-1]])
    ones = np.ones(len(both))
    size = (len(vertices), len(vertices))
    sums = scipy.sparse.csr_array((ones, (both[:, 0], both[:, 1])), size)
    means = sums @ vertices / sums.sum(axis=1)[:, None]
    return ((vertices - means) * vertex_normals(vertices, faces)).sum(axis=1)


@pytest.mark.parametrize("number", [91000022, 91000163])
def test_necks_have_no_bumps_and_creases(number):
    """Vertices of men's necks stand out nearly like those of the built-in head.

    The root of the mean square of differences was 0.9 and 0.56 mm: bumps with creases beside them.
    """
    head = load("head")
    below = below_jaw(head.vertices, head.vertices[head.anatomy["menton"]])
    is_side = (below > 20.0) & (below < 60.0)
    person = person_called(number)
    more = heights_over_neighbours(person.vertices, person.faces) - heights_over_neighbours(
        head.vertices, head.faces
    )
    assert np.sqrt((more[is_side] ** 2).mean()) < 0.5


def test_faces_and_collars_keep_their_places():
    """Only skin between the jaw and the collar is evened."""
    head = load("head")
    moved = head.vertices + np.random.default_rng(0).normal(size=head.vertices.shape)
    evened = evened_neck(moved)
    below = below_jaw(head.vertices, head.vertices[head.anatomy["menton"]])
    is_kept = (below < 0.0) | (below > 75.0)
    np.testing.assert_allclose(evened[is_kept], moved[is_kept], atol=1e-9)
    assert np.abs(evened[~is_kept] - moved[~is_kept]).max() > 0.5
