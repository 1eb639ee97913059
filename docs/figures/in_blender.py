"""Run by a Python that has bpy: open an exported file in Blender and render frames of it.

    python in_blender.py FILE FOLDER FPS FRAME [FRAME ...]

Writes FOLDER/FRAME.png of each frame; of a frame called `12r`, as the add-on for Blender refines
it, for which the first frame is at rest.
"""

import math
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "blender"))
import risorius_refine

SIZE = (420, 480)  # [pixels]
LAMPS = ((-0.5, -0.6, 0.5, 7.0), (0.6, -0.5, 0.2, 3.0), (0.2, 0.6, 0.6, 5.0))  # x, y, z [m], [W]

source, folder, frames_per_second, *frames = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = int(frames_per_second)  # before the import, which turns seconds into frames
if source.endswith(".glb"):
    bpy.ops.import_scene.gltf(filepath=source)
    bpy.data.objects["Icosphere"].hide_render = True  # what bones are drawn as
else:
    bpy.ops.wm.usd_import(filepath=source)
for material in bpy.data.materials:  # colours of vertices, which no shader uses by itself
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next((each for each in nodes if each.type == "BSDF_PRINCIPLED"), None)
    if shader is not None and not any(each.type == "TEX_IMAGE" for each in nodes):
        colour = nodes.new("ShaderNodeVertexColor")
        links.new(colour.outputs["Color"], shader.inputs["Base Color"])
for x, y, z, power in LAMPS:
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
    lamp.data.energy, lamp.data.size, lamp.location = power, 0.4, (x, y, z)
    lamp.rotation_euler = (-lamp.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(lamp)
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location, camera.rotation_euler = (-0.24, -0.86, -0.022), (math.radians(90), 0, -0.27)
camera.data.lens = 100.0
scene.collection.objects.link(camera)
scene.camera = camera
scene.world = bpy.data.worlds.new("world")
scene.world.color = (0.5, 0.51, 0.53)
scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 32, "CPU"
scene.render.resolution_x, scene.render.resolution_y = SIZE
scene.view_settings.view_transform = "Standard"
for frame in frames:
    if frame.endswith("r"):
        risorius_refine.register()
        scene.frame_set(0)
        skins = (item for item in scene.objects if item.type == "MESH" and "skin" in item.name)
        bpy.context.view_layer.objects.active = next(skins)
        bpy.ops.object.risorius_refine()
    scene.frame_set(int(frame.rstrip("r")))
    scene.render.filepath = str(Path(folder) / f"{frame}.png")
    bpy.ops.render.render(write_still=True)
