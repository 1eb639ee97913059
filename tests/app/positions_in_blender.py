"""Run by a Python that has bpy: import a glTF file, step through it, keep where all vertices are.

    python positions_in_blender.py FILE.glb POSITIONS.npz FPS FRAMES

Positions have the axes of the file (y up) and are in metres, shape (FRAMES, V, 3) for each mesh.
"""

import sys

import bpy
import numpy as np

source, output, frames_per_second, frame_count = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = int(frames_per_second)  # before the import: it turns seconds into frames
bpy.ops.import_scene.gltf(filepath=source)
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
        name = item.name.partition(".")[0]  # a number behind it where an empty has the name, too
        found.setdefault(name, []).append(np.column_stack([x, z, -y]))
np.savez(output, **{name: np.stack(shapes) for name, shapes in found.items()})
