"""A face as it is, and refined: `refined_in_blender.py NPZ PNG`, in Blender's Python."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "blender"))
import risorius_refine

DECIMETRE = 0.01  # of millimetres
BESIDE = 1.05  # [dm] from the middle
CAMERA = (0.0, -9.5, -0.12)  # [dm]


def paint(thing: bpy.types.Object, colours: np.ndarray, roughness: float) -> None:
    """Give a mesh the colours of its vertices, linear, shape (V, 3)."""
    layer = thing.data.color_attributes.new("colour", "FLOAT_COLOR", "POINT")
    opaque = np.column_stack([colours, np.ones(len(colours))]).astype(np.float32)
    layer.data.foreach_set("color", opaque.ravel())
    material = bpy.data.materials.new("surface")
    nodes, shader = material.node_tree.nodes, material.node_tree.nodes["Principled BSDF"]
    reader = nodes.new("ShaderNodeVertexColor")
    material.node_tree.links.new(reader.outputs["Color"], shader.inputs["Base Color"])
    shader.inputs["Roughness"].default_value = roughness
    thing.data.materials.append(material)


def add(name: str, points: np.ndarray, faces: np.ndarray, x: float) -> bpy.types.Object:
    """A mesh with z upward, turned a little to the side."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((points[:, [0, 2, 1]] * [1, -1, 1] * DECIMETRE).tolist(), [], faces.tolist())
    mesh.shade_smooth()
    thing = bpy.data.objects.new(name, mesh)
    thing.location, thing.rotation_euler = (x, 0.0, 0.0), (0.0, 0.0, -0.5)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def main(file: str, picture: str) -> None:
    """Two heads side by side, whose shape key is set; the copy of one is refined."""
    data = np.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    risorius_refine.register()
    scene = bpy.context.scene
    for x in (-BESIDE, BESIDE):
        for name in data["parts"]:
            part = add(name, data[f"{name} points"], data[f"{name} faces"], x)
            paint(part, data[f"{name} colours"], 0.2)
        skin = add("skin", data["rest"], data["faces"], x)
        skin.data.materials.append(bpy.data.materials.new("skin"))
        shader = skin.data.materials[0].node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (0.55, 0.3, 0.2, 1.0)
        skin.shape_key_add(name="at rest")
        moved = data["moved"][:, [0, 2, 1]] * [1, -1, 1] * DECIMETRE
        key = skin.shape_key_add(name="joy")
        key.data.foreach_set("co", moved.astype(np.float32).ravel())
        if x > 0.0:
            bpy.context.view_layer.objects.active = skin
            bpy.ops.object.risorius_refine()
        key.value = 1.0
    scene.frame_set(2)

    world = scene.world = bpy.data.worlds.new("world")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.6, 0.65, 0.7, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.4
    light = bpy.data.objects.new("light", bpy.data.lights.new("light", "SUN"))
    light.data.energy, light.data.angle = 2.6, 0.3
    light.rotation_euler = (0.9, 0.0, -0.8)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = CAMERA, (np.pi / 2, 0.0, 0.0)
    camera.data.lens = 66.0
    for thing in (light, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.seed = "CYCLES", 48, 1
    scene.render.resolution_x, scene.render.resolution_y = 960, 560
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = picture
    bpy.ops.render.render(write_still=True)


main(*sys.argv[1:])
