"""What can be animated: the head, the plane and the cloth, with all that is seen of them.

`build_scene` makes one by its name. Nothing here knows of refinement or drawing.
"""

from .scene import (
    BUILT_IN,
    OWN,
    SCENES,
    ClothScene,
    FaceScene,
    PlaneScene,
    Scene,
    build_scene,
    clamped,
    own_head,
)

__all__ = [
    "BUILT_IN",
    "OWN",
    "SCENES",
    "ClothScene",
    "FaceScene",
    "PlaneScene",
    "Scene",
    "build_scene",
    "clamped",
    "own_head",
]
