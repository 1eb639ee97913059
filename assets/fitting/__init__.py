"""Fit the built-in head's landmarks, rig and organs to a user's mesh.

    head = assets.fitting.fit_head("anna.obj", "anna_landmarks.json")
    simulation = sim.create(head)

The 68 iBug landmarks are needed, unless the topology is known (topologies.py). The page for users
is docs/own_head.md. Start reading at head.py.
"""

from .head import FittedHead, fit, fit_head
from .simplified_head import simplified_head
from .simplifying import SimulatedHead

__all__ = ["FittedHead", "SimulatedHead", "fit", "fit_head", "simplified_head"]
