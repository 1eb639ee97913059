"""Risorius' simulation: a mass-spring face driven by muscle contraction.

    simulation = sim.create(assets.load("head"))
    simulation.controls.set("zygomaticus_major_left", 0.8)
    simulation.step(1 / 60)
    simulation.positions        # (V, 3)

It imports neither rendering nor refinement. Start reading at face.py; rig.py defines the rig file.
"""

from typing import Any

from .face import Simulation, SimulationUnstable
from .face_model import build_face_model
from .foundation import controls_of
from .pulling import Pull, motion_of
from .rig import Rig, read_rig

__all__ = ["Pull", "Rig", "Simulation", "SimulationUnstable"]
__all__ += ["controls_of", "create", "motion_of", "read_rig"]


def create(head: Any) -> Simulation:
    """Build the simulation of a head: any object with `vertices` (V, 3) and `faces` (F, 3).

    Optional attributes (landmarks, rig, mandible_weight, jaw_axis, eyes) add muscles, jaw and gaze;
    foundation.py lists them. Raises ValueError, which names the fault of the head or of its rig.
    """
    return Simulation(build_face_model(head))
