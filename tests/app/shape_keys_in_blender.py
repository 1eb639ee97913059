"""A program for a Python with bpy: import an avatar, store each shape key's displacements.

    python shape_keys_in_blender.py AVATAR.glb KEYS.npz

Arrays are named MESH/KEY, and have shape (V, 3), Blender's axes (z up) and metres.
"""

import sys

import bpy
import numpy as np

source, output = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)
found = {}
for item in bpy.context.scene.objects:
    if item.type != "MESH" or item.data.shape_keys is None:
        continue
    mesh = item.name.partition(".")[0]  # Blender appends a number if an empty has the same name
    places = {}
    for key in item.data.shape_keys.key_blocks:
        places[key.name] = np.empty(3 * len(item.data.vertices), np.float32)
        key.data.foreach_get("co", places[key.name])
    rest = places.pop("Basis")
    for name, moved in places.items():
        found[f"{mesh}/{name}"] = (moved - rest).reshape(-1, 3)
np.savez(output, **found)
