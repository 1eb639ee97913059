"""The compiled kernels against plain numpy written from the formulas, and forces against energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

import sim
from assets.model import Head
from sim.contact import FORWARD_SEAL, seal_forces, watch_eyeballs
from sim.fibres import LEAST_ARC, SAMPLES, contract_fibres
from sim.lids import turn_lids
from sim.springs import edge_forces
from sim.tissue import carry, tissue_energy, tissue_forces
from tests.sim.poses import FRAME, settle

Array = npt.NDArray[np.float64]


@pytest.fixture
def stirred(simulation: sim.Simulation, generator: np.random.Generator) -> sim.Simulation:
    """A face in the middle of a wild pose."""
    values = {name: generator.uniform(0.1, high) for name, (_, high) in simulation.limits.items()}
    settle(simulation, values, frames=5)
    return simulation


def test_edge_forces(stirred: sim.Simulation) -> None:
    """Biphasic tension along each edge plus shear on the difference of the ends' offsets."""
    edges, x = stirred._anatomy.edges, stirred._x
    offset = x - stirred._carried
    force = np.zeros_like(x)
    edge_forces(
        x, offset, edges.edges, edges.rest_length, edges.stiffness, edges.shear,
        edges.stiffening, edges.strain_limit, force,
    )  # fmt: skip
    i, j = edges.edges.astype(np.int64).T
    along = x[j] - x[i]
    length = np.linalg.norm(along, axis=1)
    strain = length / edges.rest_length - 1.0
    beyond = np.maximum(strain - edges.strain_limit, 0.0)
    tension = edges.stiffness * edges.rest_length * (strain + (edges.stiffening - 1.0) * beyond)
    pull = (tension / length)[:, None] * along + edges.shear[:, None] * (offset[j] - offset[i])
    expected = np.zeros_like(x)
    np.add.at(expected, i, pull)
    np.add.at(expected, j, -pull)
    assert (beyond > 0.0).any()
    assert np.allclose(force, expected, rtol=1e-9, atol=1e-6 * np.abs(expected).max())
    assert np.abs(force.sum(axis=0)).max() < 1e-6 * np.abs(force).sum()


def test_tissue_forces(stirred: sim.Simulation) -> None:
    """Anchors are soft along the skin and stiff across it; muscles add hold and pull."""
    springs, x = stirred._anatomy.springs, stirred._x
    force, offset = np.zeros_like(x), np.zeros_like(x)
    tissue_forces(
        x, stirred._carried, stirred._normals, springs.tangential, springs.normal,
        stirred._hold, stirred._pull, offset, force,
    )  # fmt: skip
    away = x - stirred._carried
    n = stirred._normals
    across = (away * n).sum(axis=1, keepdims=True) * n
    expected = stirred._pull - stirred._hold[:, None] * away
    expected -= springs.tangential[:, None] * (away - across) + springs.normal[:, None] * across
    assert np.array_equal(offset, away)
    assert np.allclose(force, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_forces_are_the_gradient_of_the_energy(stirred: sim.Simulation) -> None:
    """Without muscle pull and contact, forces are minus the slope of the energy."""
    anatomy, x = stirred._anatomy, stirred._x.copy()
    springs, edges, hold = anatomy.springs, anatomy.edges, stirred._hold
    no_pull, offset, force = (np.zeros_like(x) for _ in range(3))
    tissue_forces(
        x, stirred._carried, stirred._normals, springs.tangential, springs.normal, hold,
        no_pull, offset, force,
    )  # fmt: skip
    edge_forces(
        x, offset, edges.edges, edges.rest_length, edges.stiffness, edges.shear,
        edges.stiffening, edges.strain_limit, force,
    )  # fmt: skip

    def energy(at: Array) -> float:
        held = tissue_energy(at, stirred._carried, stirred._normals, springs, hold)
        return held + edges.energy(at, at - stirred._carried)

    direction = np.sin(np.arange(x.size)).reshape(x.shape)
    slope = (energy(x + 1e-5 * direction) - energy(x - 1e-5 * direction)) / 2e-5
    assert -slope == pytest.approx(float((force * direction).sum()), rel=1e-4)


def test_seal_forces(stirred: sim.Simulation, generator: np.random.Generator) -> None:
    """The seal pulls lip pairs back to how they lay at rest and leaves sliding sideways free."""
    lips, rest = stirred._anatomy.lips, stirred._anatomy.surface.positions
    moved = generator.normal(size=rest.shape)
    force = np.zeros_like(rest)
    seal_forces(rest + moved, rest, lips.lower, lips.upper, lips.share, lips.seal, 0.7, force)
    w = lips.share[:, None]
    apart = moved[lips.lower] - w * moved[lips.upper[:, 0]] - (1.0 - w) * moved[lips.upper[:, 1]]
    pull = 0.7 * lips.seal[:, None] * apart * (0.0, 1.0, FORWARD_SEAL)
    expected = np.zeros_like(rest)
    np.add.at(expected, lips.lower, -pull)
    np.add.at(expected, lips.upper[:, 0], w * pull)
    np.add.at(expected, lips.upper[:, 1], (1.0 - w) * pull)
    assert len(lips.lower) >= 12
    assert np.allclose(force, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_fibres_contract_along_their_own_arc(stirred: sim.Simulation) -> None:
    """The point at arc length t goes to where t (1 - c a) was, on the fibre moved by the jaw."""
    muscles, mandible = stirred._anatomy.muscles, stirred._mandible
    bundle = muscles.bundle
    activation = np.linspace(0.0, 1.0, len(bundle.muscle))
    table = np.zeros_like(muscles.table)
    contract_fibres(
        bundle.points, bundle.mandible, bundle.contraction, bundle.gain, activation,
        mandible.rotation, mandible.shift, table,
    )  # fmt: skip
    t = np.linspace(0.0, 1.0, SAMPLES)
    for b in range(1, len(bundle.muscle)):
        points = bundle.points[b]
        moved = points + bundle.mandible[b][:, None] * mandible.displacements(points)
        arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(moved, axis=0), axis=1))]
        kept = max(1.0 - bundle.contraction[b] * activation[b], LEAST_ARC)
        for k in range(3):
            to = np.interp(kept * t * arc[-1], arc, moved[:, k])
            at = np.interp(t * arc[-1], arc, moved[:, k])
            assert np.allclose(table[b, :, k], bundle.gain[b] * (to - at), atol=1e-9)


def test_muscle_pull(stirred: sim.Simulation) -> None:
    """Hold and pull of all muscles, summed muscle by muscle and fibre by fibre."""
    anatomy, mandible = stirred._anatomy, stirred._mandible
    muscles, weight = anatomy.muscles, anatomy.skull.mandible_weight
    activation = np.linspace(-0.1, 1.0, len(muscles.names))
    hold, force = np.zeros(len(weight)), np.zeros((len(weight), 3))
    muscles.add(activation, mandible, weight, hold, force)
    a = np.maximum(activation, 0.0)
    tight = muscles.passive + (1.0 - muscles.passive) * a
    owner = np.repeat(np.arange(len(a)), np.diff(muscles.holds.rows))
    i, steady = muscles.holds.vertex, muscles.holds.value
    expected_hold = np.zeros_like(hold)
    np.add.at(expected_hold, i, (1.0 - muscles.passive) * a[owner] * muscles.holds.weight)
    turned = steady + weight[i, None] * (steady @ mandible.rotation.T - steady)
    expected = np.zeros_like(force)
    np.add.at(expected, i, (tight * a)[owner, None] * turned)
    fibre = np.repeat(np.arange(len(muscles.table)), np.diff(muscles.pulls.rows))
    s = np.minimum(muscles.pulls.value.astype(int), SAMPLES - 2)
    t = (muscles.pulls.value - s)[:, None]
    along = (1.0 - t) * muscles.table[fibre, s] + t * muscles.table[fibre, s + 1]
    on = muscles.bundle.muscle[fibre]
    strength = np.where(a[on] > 0.0, tight[on], 0.0) * muscles.pulls.weight
    np.add.at(expected, muscles.pulls.vertex, strength[:, None] * along)
    assert np.allclose(hold, expected_hold, rtol=1e-9)
    assert np.allclose(force, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_bones_carry_anchors(stirred: sim.Simulation) -> None:
    """Anchors blend between cranium and mandible by weight; their normals stay unit."""
    anatomy, mandible = stirred._anatomy, stirred._mandible
    surface, weight = anatomy.surface, anatomy.skull.mandible_weight
    carried, normals = np.zeros_like(surface.positions), np.zeros_like(surface.positions)
    carry(
        surface.positions, surface.normals, weight, mandible.rotation, mandible.shift,
        carried, normals,
    )  # fmt: skip
    moved = mandible.displacements(surface.positions)
    assert np.allclose(carried, surface.positions + weight[:, None] * moved, atol=1e-12)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)


def test_lids_turn_about_the_eyeball(simulation: sim.Simulation) -> None:
    """Lids keep their distance to the eyeball's centre; closed margins meet in angle."""
    anatomy = simulation._anatomy
    lids, eyes, rest = anatomy.lids, anatomy.skull.eyes, anatomy.surface.positions
    assert lids is not None
    carried, normals = rest.copy(), anatomy.surface.normals.copy()
    drive = np.array([[1.0, 0.4, 0.0]] * len(lids.centres))
    turn_lids(
        lids.vertex, lids.eye, lids.upper, lids.weight, lids.opening, lids.centres, lids.up,
        lids.forward, drive, 0.3, eyes.upper_lid_follows, eyes.lower_lid_follows,
        eyes.blink_meeting, rest, carried, normals,
    )  # fmt: skip
    centre = lids.centres[lids.eye]
    before = np.linalg.norm(rest[lids.vertex] - centre, axis=1)
    assert np.allclose(np.linalg.norm(carried[lids.vertex] - centre, axis=1), before)
    angle = [
        np.arctan2(
            ((x[lids.vertex] - centre) * lids.up[lids.eye]).sum(axis=1),
            ((x[lids.vertex] - centre) * lids.forward[lids.eye]).sum(axis=1),
        )
        for x in (rest, carried)
    ]
    turned = angle[1] - angle[0]
    margin = (lids.weight == 1.0) & (lids.opening > 0.1)
    lower, upper = margin & ~lids.upper, margin & lids.upper
    assert np.allclose(turned[lower], eyes.blink_meeting * lids.opening[lower])
    assert np.all(turned[upper] <= -(1.0 - eyes.blink_meeting) * lids.opening[upper])


def test_a_step_is_its_substeps(head: Head) -> None:
    """A frame without contact, done again with plain Euler, lands on the same positions."""
    anatomy = sim.create(head)._anatomy
    free = replace(
        anatomy,
        lips=replace(anatomy.lips, least_gap=anatomy.lips.least_gap - 100.0),
        eye_contact=watch_eyeballs(anatomy.surface, ()),
    )
    fast, plain = sim.Simulation(free), sim.Simulation(free)
    values = {"zygomaticus_major_left": 1.0, "frontalis_medial_right": 1.0}
    fast.set_all(values)
    plain.set_all(values)
    fast.step(FRAME)
    for _ in range(2):
        plain._controls.advance(FRAME / 2.0)
        plain._place_targets()
        for _ in range(4):
            _plain_substep(plain, FRAME / 8.0)
    moved = plain._x - plain._anatomy.surface.positions
    expected = plain.rest_positions + plain._anatomy.frame.vectors_to_head(moved)
    assert np.abs(fast.positions - expected).max() < 1e-6
    assert np.abs(fast.positions - fast.rest_positions).max() > 0.05


def _plain_substep(face: sim.Simulation, h: float) -> None:
    """Forces by numpy, then velocity, then position."""
    anatomy, x, v = face._anatomy, face._x, face._v
    springs, edges, lips = anatomy.springs, anatomy.edges, anatomy.lips
    rest = anatomy.surface.positions
    away, n = x - face._carried, face._normals
    across = (away * n).sum(axis=1, keepdims=True) * n
    force = face._pull - (face._hold + springs.tangential)[:, None] * away
    force -= (springs.normal - springs.tangential)[:, None] * across
    i, j = edges.edges.astype(np.int64).T
    along = x[j] - x[i]
    length = np.linalg.norm(along, axis=1)
    extension = length - edges.rest_length
    beyond = np.maximum(extension - edges.strain_limit * edges.rest_length, 0.0)
    tension = edges.stiffness * (extension + (edges.stiffening - 1.0) * beyond) / length
    pull = tension[:, None] * along + edges.shear[:, None] * (away[j] - away[i])
    np.add.at(force, i, pull)
    np.add.at(force, j, -pull)
    w, moved = lips.share[:, None], x - rest
    apart = moved[lips.lower] - w * moved[lips.upper[:, 0]] - (1.0 - w) * moved[lips.upper[:, 1]]
    seal = face._seal * lips.seal[:, None] * apart * (0.0, 1.0, FORWARD_SEAL)
    np.add.at(force, lips.lower, -seal)
    np.add.at(force, lips.upper[:, 0], w * seal)
    np.add.at(force, lips.upper[:, 1], (1.0 - w) * seal)
    stiff = (springs.tangential + face._hold) / anatomy.mass
    tissue = anatomy.rig.tissue
    damping = tissue.damping + 2.0 * tissue.damping_ratio * np.sqrt(stiff)
    v[:] = (v + h * force / anatomy.mass[:, None]) / (1.0 + h * damping)[:, None]
    x += h * v
