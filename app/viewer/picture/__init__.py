"""The picture of the scene, and the mouse in it."""
