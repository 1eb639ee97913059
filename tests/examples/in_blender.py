"""A program for Blender's Python: run the add-on on a waving sheet, and print results as JSON."""

import json
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "blender"))
import risorius_refine as addon

FRAMES = 50
FOLDER = Path(sys.argv[1])


def sheet():
    """A grid with two materials, a seam of texture coordinates, and a wave that moves it."""
    mesh = bpy.data.meshes.new("sheet")
    side = 14
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side))
    numbers = np.arange(side * side).reshape(side, side)
    first = numbers[:-1, :-1]
    right = numbers[:-1, 1:]
    opposite = numbers[1:, 1:]
    below = numbers[1:, :-1]
    points = np.stack([x.ravel(), y.ravel(), np.zeros(side * side)], axis=1)
    faces = np.stack([first, right, opposite, below], axis=2).reshape(-1, 4)
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    for name in ("skin", "cloth"):
        mesh.materials.append(bpy.data.materials.new(name))
    left = points[faces].mean(axis=1)[:, 0] < 0.0
    mesh.polygons.foreach_set("material_index", left.astype(np.int32))
    corners = points[faces][..., :2].copy()
    corners[left] += [3.0, 0.0]
    mesh.uv_layers.new(name="First")
    layer = mesh.uv_layers.new(name="Second")
    layer.uv.foreach_set("vector", corners.astype(np.float32).ravel())
    layer.active = layer.active_render = True
    heat = mesh.attributes.new("heat", "FLOAT", "POINT")
    heat.data.foreach_set("value", points[:, 0].astype(np.float32))
    thing = bpy.data.objects.new("sheet", mesh)
    add_heating(thing)
    thing.location = (1.0, 2.0, 3.0)
    bpy.context.scene.collection.objects.link(thing)
    wave = thing.modifiers.new("wave", "WAVE")
    wave.height = 0.3
    wave.width = 0.5
    wave.narrowness = 3.0
    wave.start_position_x = -1.0
    return thing


def add_heating(thing):
    """A modifier that adds the frame's number to the attribute "heat" of each point."""
    nodes = bpy.data.node_groups.new("heating", "GeometryNodeTree")
    nodes.is_modifier = True
    nodes.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    start = nodes.nodes.new("NodeGroupInput")
    end = nodes.nodes.new("NodeGroupOutput")
    store = nodes.nodes.new("GeometryNodeStoreNamedAttribute")
    store.inputs["Name"].default_value = "heat"
    named = nodes.nodes.new("GeometryNodeInputNamedAttribute")
    named.inputs["Name"].default_value = "heat"
    add = nodes.nodes.new("ShaderNodeMath")
    time = nodes.nodes.new("GeometryNodeInputSceneTime")
    nodes.links.new(start.outputs["Geometry"], store.inputs["Geometry"])
    nodes.links.new(named.outputs["Attribute"], add.inputs[0])
    nodes.links.new(time.outputs["Frame"], add.inputs[1])
    nodes.links.new(add.outputs["Value"], store.inputs["Value"])
    nodes.links.new(store.outputs["Geometry"], end.inputs["Geometry"])
    thing.modifiers.new("heating", "NODES").node_group = nodes


def column(collection, name, width, kind=np.float32):
    """One attribute of all items of a collection."""
    return addon.numbers(collection, name, width, kind)


def watch(copy, source):
    """Step through all frames, and compare each with the refiner's result."""
    seen = {"triangles": [], "others": 0, "off": 0.0, "invalid": 0, "uv_off": 0.0, "heat_off": 0.0}
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        mesh = copy.data
        seen["triangles"].append(len(mesh.polygons))
        evaluated = source.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        bound = addon.bounds[copy.session_uid]
        direct = bound.refiner.refine(addon.points_of(evaluated))
        off = np.abs(addon.points_of(mesh) - direct.positions).max()
        seen["off"] = max(seen["off"], float(off))
        seen["invalid"] += mesh.validate(verbose=True)
        uv = column(mesh.uv_layers["Second"].uv, "vector", 2)
        corners = column(mesh.loops, "vertex_index", 1, np.int32).ravel()
        seen["others"] += int((corners != direct.triangles.ravel()).sum())
        side = column(mesh.polygons, "material_index", 1, np.int32).repeat(3)
        places = addon.points_of(mesh)[corners, :2] + np.stack([3.0 * side, 0.0 * side], axis=1)
        seen["uv_off"] = max(seen["uv_off"], float(np.abs(uv - places).max()))
        heat = column(mesh.attributes["heat"].data, "value", 1).ravel()
        rest = column(source.data.attributes["position"].data, "vector", 3)
        origins = bound.refiner.origins()
        wanted = (rest[origins.vertices, 0] * origins.weights).sum(axis=1) + frame
        seen["heat_off"] = max(seen["heat_off"], float(np.abs(heat - wanted).max()))
    final = copy.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    normals = column(final.corner_normals, "vector", 3)
    shown = np.abs(normals - direct.normals[corners]).max()
    return {**seen, "normals_off": float(shown)}


def render(frames):
    """Render frames in one call, as for a film.

    Return the number of the copy's triangles in each.
    """
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (1.0, 2.0, 8.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.frame_start = frames[0]
    scene.frame_end = frames[-1]
    scene.render.filepath = str(FOLDER / "frame_")
    counts = []
    bpy.app.handlers.render_post.append(
        lambda *_: counts.append(len(bpy.data.objects["sheet refined"].data.polygons))
    )
    bpy.ops.render.render(animation=True)
    return counts


def main():
    """Collect all results for the tests."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    source = sheet()
    bpy.context.scene.frame_set(0)
    bpy.context.view_layer.objects.active = source
    seen = {"finished": list(bpy.ops.object.risorius_refine())}
    copy = bpy.data.objects["sheet refined"]
    seen["problem"] = copy.risorius.problem
    seen["hidden"] = source.hide_render
    seen["again"] = bpy.ops.object.risorius_refine.poll()
    seen["materials"] = [material.name for material in copy.data.materials]
    seen["uv_shown"] = copy.data.uv_layers.active.name
    seen["world"] = [list(copy.matrix_world.translation), list(source.matrix_world.translation)]
    seen.update(watch(copy, source))

    copy.risorius.blend = False
    seen["unblended"] = len(copy.data.polygons)
    copy.risorius.look = "PAPER"
    seen["paper"] = len(copy.data.polygons)
    copy.risorius.look = "SMOOTH"

    seen["rendered"] = render([10, 14])
    seen["triangles_there"] = []
    for frame in range(10, 15):
        bpy.context.scene.frame_set(frame)
        seen["triangles_there"].append(len(copy.data.polygons))

    bpy.context.scene.frame_set(11)
    seen["kept"] = list(bpy.ops.object.risorius_keep())
    seen["kept_at"] = bpy.context.scene.frame_current
    seen["kept_triangles"] = []
    seen["kept_corners"] = []
    for frame in range(10, 15):
        bpy.context.scene.frame_set(frame)
        corners = column(copy.data.loops, "vertex_index", 1, np.int32).ravel()
        seen["kept_triangles"].append(len(copy.data.polygons))
        seen["kept_corners"].append(int(corners @ np.arange(len(corners))))
    evaluated = source.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    direct = addon.bounds[copy.session_uid].refiner.refine(addon.points_of(evaluated))
    seen["kept_off"] = float(np.abs(addon.points_of(copy.data) - direct.positions).max())
    seen["let_go"] = list(bpy.ops.object.risorius_change())

    file = FOLDER / "saved.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    bpy.ops.wm.open_mainfile(filepath=str(file))
    copy = bpy.data.objects["sheet refined"]
    bpy.context.scene.frame_set(12)
    seen["after_loading"] = len(copy.data.polygons)

    copy.risorius.source.modifiers.new("more", "SUBSURF")
    bpy.context.scene.frame_set(13)
    seen["other_mesh"] = copy.risorius.problem
    copy.risorius.source.modifiers.remove(copy.risorius.source.modifiers["more"])
    bpy.context.scene.frame_set(12)
    seen["mended"] = [copy.risorius.problem, len(copy.data.polygons)]
    bpy.ops.ed.undo_push(message="smooth")
    copy.risorius.look = "PAPER"
    bpy.ops.ed.undo_push(message="paper")
    seen["steps"] = []
    for step in (bpy.ops.ed.undo, bpy.ops.ed.redo):
        step()
        copy = bpy.data.objects["sheet refined"]
        bpy.context.scene.frame_set(12)
        seen["steps"].append([copy.risorius.look, len(copy.data.polygons)])
    addon.unregister()
    seen["registered"] = hasattr(bpy.types.Object, "risorius")
    addon.register()
    addon.unregister()
    print("SEEN " + json.dumps(seen))


main()
