"""A program for a Python with bpy: import a file, step through it, store all positions.

    python positions_in_blender.py FILE POSITIONS.npz FPS FRAMES

Positions have the axes of the file (y up) and are in metres, shape (FRAMES, V, 3) for each mesh; a
mesh that changes has arrays (V, 3), named MESH/FRAME.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

source, output, frames_per_second, frame_count = sys.argv[1:]
suffix = Path(source).suffix
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = int(frames_per_second)  # before the import, which converts seconds to frames
if suffix == ".glb":
    bpy.ops.import_scene.gltf(filepath=source)
elif suffix == ".pc2":
    bpy.ops.wm.obj_import(filepath=str(Path(source).with_suffix(".obj")))
    cache = bpy.context.selected_objects[0].modifiers.new("motion", "MESH_CACHE")
    cache.cache_format = "PC2"
    cache.filepath = source
    cache.frame_start = 0.0
else:
    bpy.ops.wm.usd_import(filepath=source)
found = {}
for frame in range(int(frame_count)):
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    for item in scene.objects:
        if item.type != "MESH":
            continue
        mesh = item.evaluated_get(graph).data
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        matrix = np.array(item.evaluated_get(graph).matrix_world)
        x, y, z = (points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]).T
        name = item.name.partition(".")[0]  # Blender appends a number if an empty has the same name
        found.setdefault(name, []).append(np.column_stack([x, z, -y]))
arrays = {}
for name, shapes in found.items():
    if len({len(shape) for shape in shapes}) == 1:
        arrays[name] = np.stack(shapes)
    else:
        arrays.update({f"{name}/{frame}": shape for frame, shape in enumerate(shapes)})
np.savez(output, **arrays)
