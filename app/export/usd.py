"""Writes USD: each surface is a mesh under one root, in millimetres; motion is time samples.

The file is a package (.usdz) with a layer and the picture of the skin.

Source: Pixar, OpenUSD's schemas UsdGeomMesh (points, normals, primvars) and UsdPreviewSurface.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image

from risorius.geometry.colour import to_linear

from ..extras import optional_import
from ..rig.surface import METRES_PER_MILLIMETRE, MovingSurface
from ..text import as_text
from .clip import Clip
from .formats import ExportRequest

Gf, Sdf, Tf, Usd, UsdGeom, UsdShade, UsdUtils, Vt = (
    optional_import(f"pxr.{name}", "USD", "export", package="usd-core")
    for name in ("Gf", "Sdf", "Tf", "Usd", "UsdGeom", "UsdShade", "UsdUtils", "Vt")
)

PICTURE_NAME = "skin.png"
ALL_TIMES = Usd.TimeCode.Default()


def write_usd(clip: Clip, part: Path, request: ExportRequest) -> None:
    """Write the package; raises OSError if the disk is full."""
    is_text = as_text(part) == str(part)  # USD only accepts names in UTF-8
    with tempfile.TemporaryDirectory(dir=part.parent if is_text else None) as folder:
        layer = Path(folder) / (f"{part.stem}.usdc" if is_text else "motion.usdc")
        picture = Path(folder) / PICTURE_NAME
        package = Path(folder) / "package.usdz"
        if clip.scene.skin.albedo is not None:
            PIL.Image.fromarray(clip.scene.skin.albedo).save(picture)
        try:
            stage = Usd.Stage.CreateNew(str(layer))
            _fill_stage(stage, clip, request)
            stage.Save()
            is_made = UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(layer)), str(package))
            if is_made:
                shutil.move(package, part)
        except Tf.ErrorException:
            is_made = False
    if not is_made:
        raise OSError("the USD file is not complete; the disk may be full")


def _fill_stage(stage: Any, clip: Clip, request: ExportRequest) -> None:
    """Add the clip to the stage, with a time code for each frame."""
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, METRES_PER_MILLIMETRE)
    stage.SetTimeCodesPerSecond(clip.frames_per_second)
    stage.SetFramesPerSecond(clip.frames_per_second)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(clip.frame_count - 1)
    root = UsdGeom.Xform.Define(stage, f"/{clip.scene.name}")
    stage.SetDefaultPrim(root.GetPrim())
    for surface in clip.surfaces:
        name = Tf.MakeValidIdentifier(surface.name)
        mesh = UsdGeom.Mesh.Define(stage, root.GetPath().AppendChild(name))
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        if surface is clip.skin and request.refinement is not None:
            _add_refined(mesh, clip, request)
        else:
            _add_surface(mesh, surface, request)
        has_picture = surface.uv is not None and clip.scene.skin.albedo is not None
        _add_material(stage, mesh, surface, has_picture=has_picture)


def _add_surface(mesh: Any, surface: MovingSurface, request: ExportRequest) -> None:
    """Add a mesh with constant triangles; its points move, or the mesh moves as a whole."""
    _set_faces(mesh, surface.faces, ALL_TIMES)
    if surface.shapes is None:
        _set_points(mesh, surface.rest, surface.normals_of(surface.rest, None), ALL_TIMES)
    else:
        frames = request.counted(surface.shapes.astype(np.float64), len(surface.shapes))
        for frame, points in enumerate(frames):
            _set_points(mesh, points, surface.normals_of(points, frame), frame)
    if surface.matrices is not None:
        moves = np.ptp(surface.matrices, axis=0).any()
        operation = mesh.AddTransformOp()
        matrices = [Gf.Matrix4d(matrix.T) for matrix in surface.matrices]  # USD uses row vectors
        if not moves:
            operation.Set(matrices[0], ALL_TIMES)
        else:
            for frame, matrix in enumerate(matrices):
                operation.Set(matrix, frame)
    if surface.uv is not None and surface.face_uv is not None:
        st = _primvar(mesh, "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying)
        st.Set(Vt.Vec2fArray.FromNumpy(surface.uv))
        st.SetIndices(Vt.IntArray.FromNumpy(surface.face_uv.ravel()))
    if surface.colours is not None:
        kind = Sdf.ValueTypeNames.Color3fArray
        colours = _primvar(mesh, "displayColor", kind, UsdGeom.Tokens.vertex)
        colours.Set(Vt.Vec3fArray.FromNumpy(to_linear(surface.colours).astype(np.float32)))


def _add_refined(mesh: Any, clip: Clip, request: ExportRequest) -> None:
    """Add the refined skin, which has its own triangles in each frame."""
    assert request.refinement is not None
    kind = Sdf.ValueTypeNames.TexCoord2fArray
    st = None if clip.skin.uv is None else _primvar(mesh, "st", kind, UsdGeom.Tokens.vertex)
    frames = request.counted(clip.refined(request.refinement), clip.frame_count)
    for frame, refined in enumerate(frames):
        _set_faces(mesh, refined.triangles, frame)
        _set_points(mesh, refined.positions, refined.normals, frame)
        if st is not None and refined.uv is not None:
            st.Set(Vt.Vec2fArray.FromNumpy(refined.uv.copy()), frame)


def _set_faces(mesh: Any, faces: npt.NDArray[Any], when: Any) -> None:
    """Set triangles, from a time on or for all times."""
    counts = np.full(len(faces), 3, np.int32)
    corners = faces.astype(np.int32).ravel()
    mesh.CreateFaceVertexCountsAttr().Set(Vt.IntArray.FromNumpy(counts), when)
    mesh.CreateFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(corners), when)


def _set_points(mesh: Any, points: npt.NDArray[Any], normals: npt.NDArray[Any], when: Any) -> None:
    """Set vertices, normals, and the box around them."""
    extent = np.stack([points.min(axis=0), points.max(axis=0)])
    for attribute, rows in (
        (mesh.CreatePointsAttr(), points),
        (mesh.CreateNormalsAttr(), normals),
        (mesh.CreateExtentAttr(), extent),
    ):
        attribute.Set(Vt.Vec3fArray.FromNumpy(rows.astype(np.float32)), when)
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)


def _primvar(mesh: Any, name: str, kind: Any, interpolation: Any) -> Any:
    """Add a primvar: a value at vertices or corners."""
    return UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(name, kind, interpolation)


def _add_material(stage: Any, mesh: Any, surface: MovingSurface, *, has_picture: bool) -> None:
    """Add the material of a surface: its picture, or the colours of its vertices."""
    path = mesh.GetPath().GetParentPath().AppendChild(f"{mesh.GetPrim().GetName()}_material")
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, path.AppendChild("surface"))
    shader.CreateIdAttr("UsdPreviewSurface")
    dull_roughness = 0.6
    wet_roughness = 0.1
    roughness = dull_roughness + surface.shine * (wet_roughness - dull_roughness)
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(roughness)
    reader = UsdShade.Shader.Define(stage, path.AppendChild("reader"))
    name = reader.CreateInput("varname", Sdf.ValueTypeNames.String)
    diffuse = shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    if not has_picture:
        reader.CreateIdAttr("UsdPrimvarReader_float3")
        name.Set("displayColor")
        colours = reader.CreateOutput("result", Sdf.ValueTypeNames.Float3)
    else:
        reader.CreateIdAttr("UsdPrimvarReader_float2")
        name.Set("st")
        texture = UsdShade.Shader.Define(stage, path.AppendChild("texture"))
        texture.CreateIdAttr("UsdUVTexture")
        texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(f"./{PICTURE_NAME}")
        texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
        st = reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
        texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(st)
        colours = texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    diffuse.ConnectToSource(colours)
    output = material.CreateSurfaceOutput()
    output.ConnectToSource(shader.CreateOutput("surface", Sdf.ValueTypeNames.Token))
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
