"""Smiles of persons: weights of muscles in AU12 and joy alone, and lips that follow."""

from dataclasses import replace

import numpy as np

from risorius import sim
from risorius.assets.identities import make_person, sample_identity
from risorius.assets.identities.smiles import USUAL_SMILE, Smile, smiling
from risorius.assets.loading import load
from tests.sim.poses import advance


def test_smiles_change_two_rows_within_their_limits():
    """Smiles change the rows AU12 and joy only, and keep their weights between 0 and 1.

    The usual smile changes nothing.
    """
    layers = load("head").layers
    plain = {name: row for layer in layers for name, row in layer.rows.items()}

    def rows(smile):
        """All rows of the layers, with this smile applied."""
        return {name: row for layer in smiling(layers, smile) for name, row in layer.rows.items()}

    for name, row in rows(USUAL_SMILE).items():
        assert {key: share for key, share in row.items() if share} == plain[name]
    for sign in (-1.0, 1.0):
        found = rows(Smile(1.0, sign, sign, sign))
        assert {name for name in found if found[name] != plain[name]} == {"AU12", "joy"}
        for name in ("AU12", "joy"):
            shares = [share for share in found[name].values() if isinstance(share, float)]
            assert min(shares) >= 0.0
            assert max(shares) <= 1.0


def test_a_lifted_smile_bares_more_teeth_and_a_shut_one_stays_shut():
    """A smile with lifted lips bares more teeth in joy; AU12 alone does not part the lips."""
    identity = sample_identity(110)
    heights = []
    slits = []
    for lift in (0.0, 1.0):
        person = make_person(replace(identity, smile=Smile(lift=lift)))
        simulation = sim.create(person)
        lips = person.landmarks[[62, 66]]
        for name, found in (("AU12", slits), ("joy", heights)):
            simulation.reset()
            simulation.controls.set(name, 1.0)
            advance(simulation, 20, 0.05)
            upper, lower = simulation.positions[lips, 1]
            found.append(upper if name == "joy" else upper - lower)
            simulation.controls.set(name, 0.0)
    assert heights[1] > heights[0] + 0.5
    assert max(slits) < min(slits) + 0.3


def test_a_third_of_people_smile_with_the_raisers_of_the_lip():
    """A third of persons raise the upper lip when they smile.

    Rubin 1974: 31 % canine and 2 % full-denture smiles. Women's lips are lifted farther.
    """
    lifts = np.array([sample_identity(seed).smile.lift for seed in range(300)])
    assert 0.27 < (lifts >= 0.4).mean() < 0.39
