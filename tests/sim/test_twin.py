"""The compiled kernels compared with plain numpy written from the formulas."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.linalg import norm

from risorius import sim
from risorius.geometry.steps import smoothstep
from risorius.sim.contact import Grip
from risorius.sim.eye_contact import watch_eyeballs
from risorius.sim.fibres import FIBRE_POINTS, LEAST_ARC, SAMPLE_COUNT, contract
from risorius.sim.lid_motion import turn_lids
from risorius.sim.muscles import place_muscles
from risorius.sim.rig import LinearMuscle, RingMuscle
from risorius.sim.skin_model import Tick
from risorius.sim.skull import REST_MOTION
from risorius.sim.state import State
from risorius.sim.substep import SEAL_AXES, edge_forces, hold_lips, substeps_in, tissue_forces
from risorius.sim.tissue import carry
from tests.sim.poses import FRAME_TIME, settled_displacement


@pytest.fixture
def stirred(simulation: sim.Simulation, generator: np.random.Generator) -> sim.Simulation:
    """A face in the middle of a wild pose."""
    values = {name: generator.uniform(0.1, 1.0) for name in simulation.controls.lowest}
    settled_displacement(simulation, values, frames=5)
    return simulation


def test_edge_forces(stirred, model, state):
    """Each edge has biphasic tension, and shear on the difference of its ends' offsets."""
    edges = model.skin.edges
    x = state.x
    state.offset[:] = x - state.carried
    state.force[:] = 0.0
    edge_forces(state, edges)
    i, j = edges.edges.astype(np.int64).T
    along = x[j] - x[i]
    length = norm(along, axis=1)
    strain = length / edges.rest_length - 1.0
    beyond = np.maximum(strain - edges.strain_limit, 0.0)
    tension = edges.stiffness * edges.rest_length * (strain + (edges.stiffening - 1.0) * beyond)
    pull = (tension / length)[:, None] * along
    pull += edges.shear[:, None] * (state.offset[j] - state.offset[i])
    expected = np.zeros_like(x)
    np.add.at(expected, i, pull)
    np.add.at(expected, j, -pull)
    assert (beyond > 0.0).any()
    assert np.allclose(state.force, expected, rtol=1e-9, atol=1e-6 * np.abs(expected).max())
    assert np.abs(state.force.sum(axis=0)).max() < 1e-6 * np.abs(state.force).sum()


def test_tissue_forces(stirred, model, state):
    """Anchors are soft along the skin and stiff across it; muscles add hold and pull."""
    springs = model.skin.tissue
    tissue_forces(state, springs)
    away = state.x - state.carried
    across = (away * state.normals).sum(axis=1, keepdims=True) * state.normals
    expected = state.pull - state.hold[:, None] * away
    expected -= springs.tangential[:, None] * (away - across) + springs.normal[:, None] * across
    assert np.array_equal(state.offset, away)
    assert np.allclose(state.force, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_seal_is_an_implicit_spring(stirred, model, state, generator):
    """A single pair's speed after a substep follows from its spring's force at the end."""
    skin = model.skin
    h = 0.002
    grip = Grip(3.0, 5.0, 0.4)
    rest = skin.rest
    mass = skin.mass
    lips = skin.lips
    for pair in (0, 7, 11, len(lips.vertex) - 1):
        alone = lips._replace(
            seal=np.where(np.arange(len(lips.vertex)) == pair, lips.seal, 0.0),
            averaging=np.ones_like(lips.averaging),
        )
        mine = state._replace(
            x=rest + generator.normal(size=rest.shape), v=generator.normal(size=rest.shape)
        )
        before = mine.v.copy()
        hold_lips(mine, skin._replace(lips=alone), Tick(1, h, grip, REST_MOTION, np.zeros((2, 3))))
        i = lips.vertex[pair]
        (a, b) = lips.beside[pair]
        w = lips.weight[pair]
        ends = mine.x + h * mine.v - rest
        apart = ends[i] - w * ends[a] - (1.0 - w) * ends[b]
        apart[1] -= lips.below[pair] * grip.overlap
        force = _firmness(grip, lips, mine.x - rest)[pair] * lips.seal[pair] * apart
        expected = np.zeros_like(rest)
        np.add.at(expected, [i, a, b], [-force, w * force, (1.0 - w) * force])
        gained = mass[:, None] * (mine.v - before) / h
        assert np.abs(force).max() > 0.0
        assert np.allclose(gained, expected, rtol=1e-6, atol=1e-9 * np.abs(force).max())


def _firmness(grip, lips, moved):
    """Factors of the seal for each pair and axis; a gap has its own, upward."""
    firmness = np.full((len(lips.vertex), 3), grip.stiffness)
    is_gap = lips.below * lips.separations(moved)[:, 1] < grip.overlap
    firmness[is_gap, 1] = grip.gap_stiffness
    return firmness * SEAL_AXES


def _sealed_speeds(skin, state, grip, h):
    """Velocities after the seal acts on all pairs at once, each with its part of the masses."""
    lips = skin.lips
    mass = skin.mass
    rest = skin.rest
    w = lips.weight[:, None]

    def difference(of):
        return of[lips.vertex] - w * of[lips.beside[:, 0]] - (1.0 - w) * of[lips.beside[:, 1]]

    inverse = (1.0 / mass)[:, None]
    light = inverse[lips.vertex] + w**2 * inverse[lips.beside[:, 0]]
    light = light + (1.0 - w) ** 2 * inverse[lips.beside[:, 1]]
    light = light / lips.averaging[:, None]
    give = h * light * lips.seal[:, None] * _firmness(grip, lips, state.x - rest)
    apart = difference(state.x - rest)
    speed = difference(state.v)
    apart[:, 1] -= lips.below * grip.overlap
    change = (speed - give * apart) / (1.0 + h * give) - speed
    impulse = change / light
    speeds = state.v.copy()
    np.add.at(speeds, lips.vertex, impulse * inverse[lips.vertex])
    np.add.at(speeds, lips.beside[:, 0], -w * impulse * inverse[lips.beside[:, 0]])
    np.add.at(speeds, lips.beside[:, 1], -(1.0 - w) * impulse * inverse[lips.beside[:, 1]])
    return speeds


@pytest.fixture(scope="module")
def placed(model):
    """The placed muscles of the built-in head."""
    return place_muscles(model.rig, model.surface, model.landmarks, model.lip_side)


def gate_of(muscle, side, model):
    """The region of a muscle in the rig: its side, and its lip."""
    gate = np.ones(model.surface.vertex_count)
    if muscle.pair and not muscle.crosses:
        gate = np.clip(0.5 + side.sign * model.surface.positions[:, 0] / 40.0, 0.0, 1.0)
    if muscle.gate != "none":
        towards = model.lip_side * (1.0 if muscle.gate == "upper_lip" else -1.0)
        gate = gate * smoothstep((towards + 0.6) / 1.6)
    return gate


def test_skin_hangs_on_fibres_by_the_formula(placed, model):
    """The weight of skin on a fibre is a Gaussian across it and beyond its end.

    Its motion follows from the contraction.
    """
    x = model.surface.positions
    for at in placed:
        if not isinstance(at.muscle, LinearMuscle):
            continue
        muscle = at.muscle
        for line in at.lines:
            fibre = line.fibre
            along = np.diff(line.points, axis=0)
            lengths = norm(along, axis=1)
            t = ((x[:, None] - line.points[:-1]) * along).sum(axis=2) / lengths**2
            t = np.clip(t, 0.0, 1.0)
            feet = line.points[:-1] + t[..., None] * along
            squared = ((x[:, None] - feet) ** 2).sum(axis=2)
            nearest = squared.argmin(axis=1)
            rows = np.arange(len(x))
            arc = (np.cumsum(lengths) - lengths)[nearest] + (t * lengths)[rows, nearest]
            arc /= lengths.sum()
            foot = feet[rows, nearest]
            squared = squared[rows, nearest]
            width, beyond = np.array([muscle.width, muscle.beyond]) * fibre.width_factor
            past = (x - line.points[-1]) @ along[-1] / lengths[-1]
            ended = np.maximum(squared - past**2, 0.0) / width**2 + (past / beyond) ** 2
            is_past = (arc >= 1.0 - 1e-12) & (past > 0.0)
            reach = np.where(is_past, ended, squared / width**2)
            weight = np.where(reach < 2.2**2, fibre.weight * np.exp(-reach), 0.0)
            weight *= gate_of(muscle, at.side, model)
            drawn = fibre.gain * fibre.convergence * muscle.contraction * arc
            bulge = muscle.bulge * np.exp(-(((arc - muscle.bulge_at) / 0.3) ** 2)) + fibre.lift
            steady = (weight * drawn)[:, None] * (foot - x)
            steady += (weight * bulge)[:, None] * model.surface.normals
            on = weight > 0.0
            assert line.skin.weight == pytest.approx(weight, rel=1e-9, abs=1e-9)
            assert line.skin.arc[on] == pytest.approx(arc[on], abs=1e-9)
            assert line.skin.steady == pytest.approx(steady, abs=1e-9)


def test_skin_hangs_on_sphincters_by_the_formula(placed, model):
    """The weight of skin on a sphincter is a Gaussian inside and outside an ellipse.

    It fades along the arc, and is 0 more than 25 mm behind the corners of the eyes.
    """
    x = model.surface.positions
    rear = model.landmarks[[36, 45], 2].mean() - 25.0
    for at in placed:
        if not isinstance(at.muscle, RingMuscle):
            continue
        muscle = at.muscle
        lateral, up, down = muscle.radii
        middle = (muscle.shape or muscle.centre).position(model.landmarks, at.side)
        aside, height, _ = (x - middle).T
        rho = np.hypot(aside / lateral, height / np.where(height > 0.0, up, down))
        outside, inside = muscle.edge
        weight = np.exp(-0.5 * (np.maximum(rho - 1.0, 0.0) / outside) ** 2)
        weight *= np.exp(-0.5 * (np.maximum(1.0 - rho, 0.0) / inside) ** 2)
        where, half, fade = muscle.arc_deg
        angle = np.degrees(np.arctan2(height, aside * at.side.sign))
        off = np.abs((angle - where + 180.0) % 360.0 - 180.0)
        weight *= smoothstep(1.0 - (off - half) / max(fade, 1e-3))
        weight *= (x[:, 2] > rear) * gate_of(muscle, at.side, model)
        assert at.lines[0].skin.weight == pytest.approx(weight, rel=1e-9, abs=1e-9)


def test_fibres_contract_along_their_own_arc(stirred, model, state):
    """The point at arc length t goes to f + (t - f)(1 - c a) on the fibre moved by the jaw.

    f: the arc length that stays; c: the contraction; a: the activation."""
    mandible = stirred.bones.mandible
    bundle = model.muscles.bundle
    activation = np.linspace(0.0, 1.0, len(bundle.muscle))
    table = np.zeros_like(state.lines.contracted)
    assert bundle.fixed_at.max() > 0.0
    t = np.linspace(0.0, 1.0, SAMPLE_COUNT)
    for b in range(1, len(bundle.muscle)):
        points = bundle.points[b]
        moved = points + bundle.mandible[b][:, None] * mandible.displacements(points)
        contract(moved, bundle.contraction[b] * activation[b], bundle.fixed_at[b], table[b])
        arc = np.r_[0.0, np.cumsum(norm(np.diff(moved, axis=0), axis=1))]
        remaining = max(1.0 - bundle.contraction[b] * activation[b], LEAST_ARC)
        there = bundle.fixed_at[b] + remaining * (t - bundle.fixed_at[b])
        for k in range(3):
            to = np.interp(there * arc[-1], arc, moved[:, k])
            at = np.interp(t * arc[-1], arc, moved[:, k])
            assert np.allclose(table[b, :, k], to - at, atol=1e-9)


def test_muscle_pull(stirred, model, state):
    """Attachment and pull of all muscles equal sums muscle by muscle and line by line."""
    mandible = stirred.bones.mandible
    muscles = model.muscles
    weight = stirred.bones.mandible_weight
    activation = np.linspace(-0.1, 1.0, len(muscles.names))
    hold = np.zeros(len(weight))
    force = np.zeros((len(weight), 3))
    muscles.add(activation, mandible, weight, state._replace(hold=hold, pull=force))
    a = np.maximum(activation, 0.0)
    skin = muscles.skin
    motion = state.lines
    assert 0.0 in skin.passive
    tight = skin.passive + (1.0 - skin.passive) * a
    owner = np.repeat(np.arange(len(a)), np.diff(skin.holds.rows))
    i = skin.holds.vertex
    steady = skin.holds.value
    held = (1.0 - skin.passive) * a
    expected_hold = np.zeros_like(hold)
    np.add.at(expected_hold, i, held[owner] * skin.holds.weight)
    turned = steady @ mandible.rotation.T
    carried = steady + weight[i, None] * (turned - steady)
    pull = tight * a
    expected = np.zeros_like(force)
    np.add.at(expected, i, pull[owner, None] * carried)
    of_line = muscles.bundle.muscle
    pulled = np.where(a[of_line] > 0.0, tight[of_line], 0.0)
    ridden = np.where(motion.is_carried, tight[of_line], 0.0)
    assert ridden.any()
    for attached, table, scale, last in (
        (skin.pulls, motion.contracted, pulled, SAMPLE_COUNT - 2),
        (skin.carries, motion.carried, ridden, FIBRE_POINTS - 2),
    ):
        line = np.repeat(np.arange(len(table)), np.diff(attached.rows))
        s = np.minimum(attached.value.astype(int), last)
        t = (attached.value - s)[:, None]
        along = (1.0 - t) * table[line, s] + t * table[line, s + 1]
        strength = scale[line] * attached.weight
        np.add.at(expected, attached.vertex, strength[:, None] * along)
    assert np.allclose(hold, expected_hold, rtol=1e-9)
    assert np.allclose(force, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_bones_carry_anchors(stirred, model, state):
    """Anchors blend cranium and mandible by weight; their normals keep length one."""
    mandible = stirred.bones.mandible
    surface = model.surface
    weight = stirred.bones.mandible_weight
    carry(state, surface.positions, surface.normals, weight, mandible)
    moved = mandible.displacements(surface.positions)
    assert np.abs(moved).max() > 5.0
    assert np.allclose(state.carried, surface.positions + weight[:, None] * moved, atol=1e-12)
    assert np.allclose(norm(state.normals, axis=1), 1.0, atol=1e-6)


def test_lids_turn_about_the_eyeball(simulation, model, state):
    """Lids keep their distance from the eyeball's centre, except for sinking; margins meet.

    Skin that slides beside the inner corner may leave the eyeball, but never enters it.
    """
    lids = model.lids.vertices
    rest = model.surface.positions
    closed = np.array([[1.0, 0.4, 0.0]] * len(lids.centres))
    gaze = np.array([[0.1, 0.3], [0.0, -0.2]])
    centre = lids.centres[lids.eye]
    flat = lids._replace(sink=np.zeros_like(lids.sink))
    turn_lids(state, rest, flat, closed, gaze)
    away = state.carried[lids.vertex] - centre
    before = norm(rest[lids.vertex] - centre, axis=1)
    after = norm(away, axis=1)
    is_inner = (away * lids.inward[lids.eye]).sum(axis=1) > 0.0
    assert np.allclose(before[~is_inner], after[~is_inner])
    assert (after > before - 1e-9).all()
    assert (after < before + 1.5).all()
    state.carried[:] = rest
    straight = flat._replace(along=np.zeros_like(lids.along))
    turn_lids(state, rest, straight, closed, gaze)

    def angle(x):
        """The angle [radians] about the axis of the lids."""
        away = x[lids.vertex] - centre
        high = (away * lids.up[lids.eye]).sum(axis=1)
        far = (away * lids.forward[lids.eye]).sum(axis=1)
        return np.arctan2(high, far)

    turned = angle(state.carried) - angle(rest)
    assert np.allclose(turned, lids.closing - np.where(lids.upper, lids.overlap, 0.0), atol=1e-9)
    assert turned[lids.upper].min() < -0.5
    assert (lids.sink != 0.0).any()


def test_an_open_lid_takes_its_fold_along(simulation, model, state):
    """The fold of a raised lid in upward gaze is held and rises; at rest no force holds it."""
    lids = model.lids.vertices
    rest = model.surface.positions
    still = np.zeros((len(lids.centres), 2))
    up = np.array([[0.0, 0.3]] * len(lids.centres))
    drive = np.zeros((len(lids.centres), 3))
    held = state.hold.copy()
    turn_lids(state, rest, lids, drive, still)
    assert np.array_equal(state.hold, held)
    turn_lids(state, rest, lids, drive, up)
    fold = lids.vertex[lids.fold_hold > 0.0]
    assert len(fold) > 10
    assert (state.hold[fold] > held[fold]).all()
    assert (state.carried - rest)[fold, 1].max() > 1.0


def test_a_step_is_its_substeps(model):
    """A frame without contact, computed with plain Euler steps, gives the same positions."""
    lips = model.skin.lips
    without_contact = model.skin._replace(
        lips=lips._replace(least_gap=lips.least_gap - 100.0),
        eyes=watch_eyeballs(model.surface, ()),
    )
    free = replace(model, skin=without_contact)
    state = State.at_rest(model.surface, len(model.muscles.bundle.muscle))
    fast = sim.Simulation(free)
    plain = sim.Simulation(free, state)
    values = {"zygomaticus_major_left": 1.0, "frontalis_medial_right": 1.0}
    fast.controls.set_all(values)
    plain.controls.set_all(values)
    fast.step(FRAME_TIME)
    plain.controls.advance(FRAME_TIME / 2.0)
    plain.place_targets()
    for _ in range(substeps_in(FRAME_TIME)):
        _plain_substep(without_contact, state, plain.grip, FRAME_TIME / substeps_in(FRAME_TIME))
    moved = state.x - model.surface.positions
    expected = plain.rest_positions + model.space.vectors_to_head(moved)
    assert np.abs(fast.positions - expected).max() < 1e-6
    assert np.abs(fast.positions - fast.rest_positions).max() > 0.05


def _plain_substep(skin, state, grip, h):
    """Forces by their kernels, which are tested above; then velocity, then position."""
    springs = skin.tissue
    x = state.x
    v = state.v
    tissue_forces(state, springs)
    edge_forces(state, skin.edges)
    stiff = (springs.tangential + state.hold) / skin.mass
    damping = springs.damping + 2.0 * springs.damping_ratio * np.sqrt(stiff)
    v[:] = (v + h * state.force / skin.mass[:, None]) / (1.0 + h * damping)[:, None]
    v[:] = _sealed_speeds(skin, state, grip, h)
    x += h * v
