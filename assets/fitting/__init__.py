"""Any head: fit what the built-in head knows to a mesh that somebody brings.

    head = assets.fitting.fit_head("anna.obj", "anna_landmarks.json")
    simulation = sim.create(head)

Needed are the 68 iBug landmarks on the mesh, nothing else; docs/own_head.md is the user's page.
Start reading at head.py.
"""

from .head import FittedHead, fit, fit_head

__all__ = ["FittedHead", "fit", "fit_head"]
