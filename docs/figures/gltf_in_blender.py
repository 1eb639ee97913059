"""Draw a glTF file as Blender shows it, three moments side by side.

    risorius export -o face.glb
    python docs/figures/gltf_in_blender.py face.glb docs/pictures/export_blender.png

The second Python has Blender's module bpy (5.0.1 drew the picture), which nothing else here needs.
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

FRAMES = (45, 85, 372)  # joy, surprise, yawn
SIZE = 480  # pixels of one moment
TARGET = Vector((0.004, -0.05, -0.024))  # between the eyes [m]
LAMPS = (((-0.45, -0.75, 0.45), 7.0), ((0.12, -0.90, -0.05), 3.0))  # place [m], power [W]


def add(kind: bpy.types.ID, place: tuple[float, float, float]) -> bpy.types.Object:
    """A camera or lamp, turned to the face."""
    item = bpy.data.objects.new(kind.name, kind)
    item.location = place
    item.rotation_euler = (TARGET - item.location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(item)
    return item


bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = 30  # before the import, which turns seconds into frames
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
bpy.data.objects["Icosphere"].hide_render = True  # what bones are drawn as
scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 24, True
scene.render.resolution_x = scene.render.resolution_y = SIZE
scene.view_settings.look = "AgX - Medium High Contrast"
scene.camera = add(bpy.data.cameras.new("camera"), (0.17, -0.72, 0.02))
scene.camera.data.lens = 88
scene.world = bpy.data.worlds.new("world")
scene.world.color = (0.42, 0.45, 0.50)
for place, power in LAMPS:
    lamp = bpy.data.lights.new("lamp", "AREA")
    lamp.energy, lamp.size = power, 0.35
    add(lamp, place)
moments = []
with tempfile.TemporaryDirectory() as folder:
    scene.render.filepath = str(Path(folder) / "moment.png")
    for frame in FRAMES:
        scene.frame_set(frame)
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        moments.append(np.array(image.pixels).reshape(SIZE, SIZE, 4))
        bpy.data.images.remove(image)
joined = bpy.data.images.new("joined", SIZE * len(FRAMES), SIZE)
joined.pixels = np.concatenate(moments, axis=1).ravel()
joined.filepath_raw, joined.file_format = str(Path(sys.argv[2]).resolve()), "PNG"
joined.save()
