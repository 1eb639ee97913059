"""Add-on for Blender: a copy of an animated mesh, refined in every frame where it bends.

Object > Refined Copy, or the tab Risorius of the 3D viewport's sidebar. Shape keys, armatures,
caches or physics may move the source: a handler of frame changes reads the evaluated mesh and
writes triangles into the copy, in the window and in renders. Python keeps no reference to Blender's
data between frames: refiners are bound again after undo and after a file is opened.
"""

from typing import Any

import bpy
import numpy as np
from bpy.app.handlers import persistent

WRITTEN_ATTRIBUTES = {"position", "custom_normal"}  # written by the copy itself
LOOK_OPTIONS = {
    "SMOOTH": {"scheme": "cubic", "criterion": "displacement+rest"},
    "PAPER": {"scheme": "loop", "criterion": "normal", "normals": "linear"},
}
VALUE_WIDTHS = {"FLOAT": 1, "FLOAT2": 2, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4}
VALUE_FIELDS = {"INT": "value", "FLOAT": "value", "FLOAT_COLOR": "color"}  # others have a "vector"
# Attribute of the mesh at rest: splits of each edge in all frames.
SPLITS_ATTRIBUTE = "risorius_splits"
bounds: dict[int, "Bound"] = {}  # number of a refined copy in this session -> its refiner


def numbers(collection: Any, name: str, width: int, kind: type) -> np.ndarray:
    """An attribute of all items of one of Blender's collections, shape (n, width)."""
    table = np.empty((len(collection), width), dtype=kind)
    collection.foreach_get(name, table.ravel())
    return table


def points_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """The positions of a mesh, shape (V, 3), in Blender's single precision."""
    return numbers(mesh.attributes["position"].data, "vector", 3, np.float32)


def values_of(mesh: bpy.types.Mesh) -> dict[str, np.ndarray]:
    """Point attributes of a mesh that may change in every frame, by name: heat, colours, strain.

    Blender's internal values and positions are left out.
    """
    found = {}
    for each in mesh.attributes:
        is_internal = each.name in WRITTEN_ATTRIBUTES or each.name.startswith(".")
        if each.domain == "POINT" and each.data_type in VALUE_WIDTHS and not is_internal:
            field = VALUE_FIELDS.get(each.data_type, "vector")
            width = VALUE_WIDTHS[each.data_type]
            found[each.name] = numbers(each.data, field, width, np.float32)
    return found


class Bound:
    """The refiner of one copy, and the data besides positions that it copies from the source."""

    def __init__(self, settings: "RisoriusSettings") -> None:
        """Bind to the mesh at rest; on a machine's first run, compilation takes seconds."""
        from risorius import refine  # imported late, so that Blender's start stays fast

        rest = settings.rest
        rest.calc_loop_triangles()
        triangles = rest.loop_triangles
        loops = numbers(triangles, "loops", 3, np.int32)
        polygons = numbers(triangles, "polygon_index", 1, np.int32).ravel()
        self.materials = numbers(rest.polygons, "material_index", 1, np.int32).ravel()[polygons]
        self.counts = len(rest.vertices), len(rest.polygons)
        self.corners = None  # corners of the copy's current triangles
        splits = rest.get(SPLITS_ATTRIBUTE)
        look = dict(LOOK_OPTIONS[settings.look])
        if splits is not None:
            del look["criterion"]
            look["splits"] = np.array(splits[:], dtype=np.uint8)
        values = values_of(rest)
        self.value_kinds = {name: rest.attributes[name].data_type for name in values}
        self.uv_shown = rest.uv_layers.active and rest.uv_layers.active.name
        self.refiner = refine.create(
            "kahler",
            numbers(triangles, "vertices", 3, np.int32),
            points_of(rest),
            attributes={
                **values,
                **{
                    layer.name: (numbers(layer.uv, "vector", 2, np.float32), loops)
                    for layer in rest.uv_layers
                },
            },
            **look,
            blend=settings.blend,
        )
        self.stays = splits is not None

    def refine(self, source: bpy.types.Mesh, mesh: bpy.types.Mesh) -> None:
        """Refine the evaluated `source` into `mesh`; raises ValueError if element counts differ."""
        if (len(source.vertices), len(source.polygons)) != self.counts:
            raise ValueError("The source has other vertices or faces than at rest")
        values = {
            name: each
            for name, each in values_of(source).items()
            if name in self.value_kinds and VALUE_WIDTHS[self.value_kinds[name]] == each.shape[1]
        }
        frame = self.refiner.refine(points_of(source), values=values)
        is_made = self.stays and self.corners is not None
        if not is_made:
            corners = frame.triangles.astype(np.int32).ravel()
            if self.corners is None or not np.array_equal(corners, self.corners):
                self.make(mesh, frame, corners)
            for name in frame.attributes.keys() - self.value_kinds.keys():
                of_corners = frame.attributes[name][frame.triangles.ravel()]
                write(mesh, name, "FLOAT2", "CORNER", of_corners)
        write(mesh, "position", "FLOAT_VECTOR", "POINT", frame.positions)
        for name, kind in self.value_kinds.items():
            write(mesh, name, kind, "POINT", frame.attributes[name])
        write(mesh, "custom_normal", "FLOAT_VECTOR", "POINT", frame.normals)
        mesh.update()

    def make(self, mesh: bpy.types.Mesh, frame: Any, corners: np.ndarray) -> None:
        """Write new triangles into the copy."""
        mesh.clear_geometry()
        mesh.vertices.add(len(frame.positions))
        mesh.loops.add(len(corners))
        mesh.polygons.add(len(frame.triangles))
        mesh.polygons.foreach_set("loop_start", np.arange(0, len(corners), 3, dtype=np.int32))
        write(mesh, ".corner_vert", "INT", "CORNER", corners)
        write(mesh, "material_index", "INT", "FACE", self.materials[frame.source])
        for name in frame.attributes.keys() - self.value_kinds.keys():
            layer = mesh.uv_layers.get(name) or mesh.uv_layers.new(name=name, do_init=False)
            layer.active = layer.active_render = name == self.uv_shown
        mesh.update(calc_edges=True)
        self.corners = corners


def write(mesh: bpy.types.Mesh, name: str, kind: str, domain: str, values: np.ndarray) -> None:
    """Set an attribute of a mesh; it is added if missing."""
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, domain)
    attribute.data.foreach_set(
        VALUE_FIELDS.get(kind, "vector"), np.ascontiguousarray(values).ravel()
    )


def update(copy: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    """Bring one copy up to date; errors are shown in its panel."""
    settings = copy.risorius
    if copy.mode == "EDIT" or settings.rest is None:
        return
    try:
        if copy.session_uid not in bounds:
            bounds[copy.session_uid] = Bound(settings)
        bounds[copy.session_uid].refine(settings.source.evaluated_get(depsgraph).data, copy.data)
        settings.problem = ""
    except (ImportError, ValueError) as error:
        settings.problem = str(error)


@persistent
def refine_frame(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Refine all copies of the scene after every change of the frame, also in renders."""
    for copy in scene.objects:
        if copy.risorius.source is not None:
            update(copy, depsgraph)


@persistent
def forget(*_: Any) -> None:
    """Forget all refiners after undo, redo, or another file, because meshes have changed."""
    bounds.clear()


def changed(settings: "RisoriusSettings", context: bpy.types.Context) -> None:
    """Bind a refiner again after a change of settings, and show the result."""
    bounds.pop(settings.id_data.session_uid, None)
    if settings.source is not None:
        update(settings.id_data, context.evaluated_depsgraph_get())


def source_changed(settings: "RisoriusSettings", context: bpy.types.Context) -> None:
    """Follow another source, and make Blender evaluate it even while it is hidden."""
    copy = settings.id_data
    copy.parent = settings.source
    # In renders Blender evaluates a hidden mesh only if a modifier uses it; this one copies no
    # data.
    follow = copy.modifiers.get("Follow Source")
    follow = follow or copy.modifiers.new("Follow Source", "DATA_TRANSFER")
    follow.object = settings.source
    changed(settings, context)


def is_source(settings: "RisoriusSettings", thing: bpy.types.Object) -> bool:
    """Whether a copy of this object can be made."""
    return thing.type == "MESH" and thing != settings.id_data


class RisoriusSettings(bpy.types.PropertyGroup):
    """Settings of each refined copy, kept in the file."""

    source: bpy.props.PointerProperty(
        name="Source", type=bpy.types.Object, poll=is_source, update=source_changed
    )
    rest: bpy.props.PointerProperty(name="At Rest", type=bpy.types.Mesh, update=changed)
    look: bpy.props.EnumProperty(
        name="Look",
        items=[
            ("SMOOTH", "Smooth", "Curves through the vertices, at rest and where it bends"),
            ("PAPER", "Paper", "Loop's rules where it bends more than at rest, as published"),
        ],
        update=changed,
    )
    blend: bpy.props.BoolProperty(
        name="Blend",
        description="New points move gradually, so nothing pops",
        default=True,
        update=changed,
    )
    problem: bpy.props.StringProperty(options={"SKIP_SAVE", "HIDDEN"})


class OBJECT_OT_risorius_refine(bpy.types.Operator):  # noqa: N801 (Blender asks for such names)
    """Add a copy that is refined where the mesh bends; call it in a frame at rest"""

    bl_idname = "object.risorius_refine"
    bl_label = "Refined Copy"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the active object is a mesh, but not a refined copy itself."""
        active = context.active_object
        is_mesh = active is not None and active.type == "MESH" and active.mode == "OBJECT"
        return is_mesh and active.risorius.source is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Add the copy, parent it to its source, and hide the source."""
        source = context.active_object
        depsgraph = context.evaluated_depsgraph_get()
        rest = bpy.data.meshes.new_from_object(source.evaluated_get(depsgraph))
        rest.name = f"{source.name} at rest"
        name = f"{source.name} refined"
        copy = bpy.data.objects.new(name, bpy.data.meshes.new(name))
        for slot in source.material_slots:
            copy.data.materials.append(slot.material)
        for collection in source.users_collection:
            collection.objects.link(copy)
        copy.risorius.rest = rest
        copy.risorius.source = source  # refines
        if copy.risorius.problem:
            self.report({"WARNING"}, copy.risorius.problem)
        source.hide_render = True
        source.hide_set(True)
        context.view_layer.objects.active = copy
        copy.select_set(True)
        # Renders change meshes that the window draws.
        context.scene.render.use_lock_interface = True
        return {"FINISHED"}


def refined_copy(context: bpy.types.Context) -> bpy.types.Object | None:
    """The active object, if it is a refined copy with a mesh at rest."""
    active = context.active_object
    settings = active and active.risorius
    return active if settings and settings.source and settings.rest else None


class OfRefinedCopy:
    """An operator for the active object; available if this object is a refined copy."""

    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the active object is a refined copy."""
        return refined_copy(context) is not None


class OBJECT_OT_risorius_keep(OfRefinedCopy, bpy.types.Operator):  # noqa: N801
    """Keep the same triangles in all frames of the scene's range, as many as its motion needs"""

    bl_idname = "object.risorius_keep"
    bl_label = "Keep One Topology"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Refine all frames, and keep the most splits of any frame at each edge."""
        copy = refined_copy(context)
        scene = context.scene
        shown = scene.frame_current
        copy.risorius.rest.pop(SPLITS_ATTRIBUTE, None)
        changed(copy.risorius, context)
        most = None
        for frame in range(scene.frame_start, scene.frame_end + 1):
            scene.frame_set(frame)
            if copy.risorius.problem:
                self.report({"ERROR"}, f"Frame {frame}: {copy.risorius.problem}")
                scene.frame_set(shown)
                return {"CANCELLED"}
            splits = bounds[copy.session_uid].refiner.splits
            most = splits.copy() if most is None else np.maximum(most, splits)
        copy.risorius.rest[SPLITS_ATTRIBUTE] = most.astype(int).tolist()
        bounds.pop(copy.session_uid, None)
        scene.frame_set(shown)
        return {"FINISHED"}


class OBJECT_OT_risorius_change(OfRefinedCopy, bpy.types.Operator):  # noqa: N801
    """Let each frame have its own triangles again"""

    bl_idname = "object.risorius_change"
    bl_label = "Change Topology"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the active object is a refined copy with one topology."""
        return super().poll(context) and SPLITS_ATTRIBUTE in refined_copy(context).risorius.rest

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forget the splits."""
        copy = refined_copy(context)
        del copy.risorius.rest[SPLITS_ATTRIBUTE]
        changed(copy.risorius, context)
        return {"FINISHED"}


class VIEW3D_PT_risorius(bpy.types.Panel):  # noqa: N801
    """The settings of the active object, if it is a refined copy."""

    bl_label = "Refinement"
    bl_category = "Risorius"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    def draw(self, context: bpy.types.Context) -> None:
        """Show the settings."""
        layout = self.layout
        layout.use_property_split = True
        active = context.active_object
        settings = active and active.risorius
        if not settings or settings.source is None:
            layout.operator(OBJECT_OT_risorius_refine.bl_idname, icon="MOD_SUBSURF")
            return
        for name in ("source", "rest", "look", "blend"):
            layout.prop(settings, name)
        is_kept = settings.rest is not None and SPLITS_ATTRIBUTE in settings.rest
        operator = OBJECT_OT_risorius_change if is_kept else OBJECT_OT_risorius_keep
        layout.operator(operator.bl_idname)
        if settings.problem:
            layout.label(text=settings.problem, icon="ERROR")
        else:
            layout.label(text=f"{len(active.data.polygons)} triangles")


def show_in_menu(menu: bpy.types.Menu, _: bpy.types.Context) -> None:
    """A row of the menu Object."""
    menu.layout.operator(OBJECT_OT_risorius_refine.bl_idname)


REGISTERED_CLASSES = (
    RisoriusSettings,
    OBJECT_OT_risorius_refine,
    OBJECT_OT_risorius_keep,
    OBJECT_OT_risorius_change,
    VIEW3D_PT_risorius,
)
REGISTERED_HANDLERS = (
    ("frame_change_post", refine_frame),
    *((name, forget) for name in ("load_post", "undo_post", "redo_post")),
)


def register() -> None:
    """Register the add-on; Blender calls this when it is switched on."""
    for one in REGISTERED_CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Object.risorius = bpy.props.PointerProperty(type=RisoriusSettings)
    bpy.types.VIEW3D_MT_object.append(show_in_menu)
    for name, handler in REGISTERED_HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Unregister the add-on; Blender calls this when it is switched off. Refined copies stay."""
    for name, handler in REGISTERED_HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    bpy.types.VIEW3D_MT_object.remove(show_in_menu)
    del bpy.types.Object.risorius
    for one in reversed(REGISTERED_CLASSES):
        bpy.utils.unregister_class(one)
    forget()
