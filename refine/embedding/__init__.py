"""A fine mesh that follows the smooth surface of a coarse one."""
