"""When the panels are drawn anew while the face moves; in between, their last image is stored.

On software OpenGL the panels cost as much as a quarter of the face, and while a script plays only
sliders creep in them: ten times a second is enough for these. Whatever the user does is answered in
the same frame. The stored image is simply what stands around the scene in the window's frame, so it
can only be reused while nothing (a menu, a message, help) lies over the scene.
"""

from __future__ import annotations

import math

REFRESH = 0.1  # [s] that a picture of the panels may be old while the face moves


class PanelCache:
    """Says whether panels are due; the window tells when it has drawn them."""

    def __init__(self) -> None:
        self.refresh = REFRESH
        self._age = math.inf  # [s]
        self._size = (0, 0)
        self._is_over_scene = True

    def age(self, seconds: float) -> None:
        """Time has passed."""
        self._age += seconds

    def are_due(self, size: tuple[int, int], *, is_moving: bool, has_input: bool) -> bool:
        """Whether to draw them in this frame, in a window of `size` pixels.

        is_moving: whether the scene has changed; else there is time. has_input: from the user.
        """
        return (
            not is_moving
            or has_input
            or self._is_over_scene
            or self._age >= self.refresh
            or size != self._size
        )

    def note_drawn(self, size: tuple[int, int], *, is_over_scene: bool) -> None:
        """They were drawn in a window of `size` pixels, some of it over the scene or nothing."""
        self._age, self._size, self._is_over_scene = 0.0, size, is_over_scene
