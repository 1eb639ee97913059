"""Tests of fine meshes that follow a coarse one."""
