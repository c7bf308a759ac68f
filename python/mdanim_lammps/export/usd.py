# SPDX-License-Identifier: GPL-2.0-only
"""USD: a mesh for each object and the liquid, drops, materials by colour, camera and light. What keeps its shape moves and turns;
all else has its points in each frame. Metres, z up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..picture.camera import action_of
from ..picture.lens import FIELD_OF_VIEW, View
from ..picture.standpoints import camera_of
from ..scene.render import Render
from .cut import Body, Cut

FLUSH = 100_000_000
"""Bytes of points after which they go to the disk, so that a long run need not fit in memory."""
OPACITY = 0.6
"""Opacity of the liquid."""
SUN, SKY = 3.0, 0.5
"""Intensities of the lamp, which is far away, and of the sky."""


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    from pxr import Sdf, Usd, UsdGeom, UsdShade, Vt

    stage = Usd.Stage.CreateNew(str(folder / f"{stem}.usdc"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    rate, codes = cut.rate, cut.times * cut.rate
    stage.SetTimeCodesPerSecond(rate)
    stage.SetFramesPerSecond(rate)
    stage.SetStartTimeCode(codes[0])
    stage.SetEndTimeCode(codes[-1])
    scene = UsdGeom.Xform.Define(stage, "/scene")
    stage.SetDefaultPrim(scene.GetPrim())
    UsdGeom.Scope.Define(stage, "/scene/materials")
    meshes, used, materials = [], {"materials", "camera", "lamp", "sky"}, {}
    array = lambda values: Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, np.float32))
    for body in cut.bodies:
        mesh = UsdGeom.Mesh.Define(stage, f"/scene/{_free_name(body.name, used)}")
        mesh.GetPrim().SetDisplayName(body.name)
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(body.triangle), 3))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(body.triangle.ravel())))
        mesh.CreatePointsAttr()
        mesh.CreateExtentAttr()
        mesh.CreateNormalsAttr()
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
        colors = np.array([body.color]) if body.paint is None else body.paint / 255.0
        kind = UsdGeom.Tokens.constant if body.paint is None else UsdGeom.Tokens.vertex
        mesh.CreateDisplayColorPrimvar(kind).Set(array(linear(colors)))
        key = (body.color if body.paint is None else None, body.clear)
        if key not in materials:
            materials[key] = _material(stage, f"/scene/materials/material_{len(materials)}", body, Sdf, UsdShade)
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(materials[key])
        meshes.append(mesh)
    drops = None
    if cut.sheds_drops:
        drops = UsdGeom.Points.Define(stage, f"/scene/{_free_name(f'{cut.liquid.name}_drops', used)}")
        UsdShade.MaterialBindingAPI.Apply(drops.GetPrim()).Bind(materials[cut.bodies[-1].color, True])
    record = cut.trajectory.scene
    render = record.render if record else Render()
    _camera(stage, cut, render)
    _lights(stage, render)
    start, motion = cut.surfaces(cut.frames[0]), cut.motion
    stiff = cut.stiff
    for n in np.flatnonzero(stiff):
        _shape(meshes[n], start[n][0] - motion.centre[0, n], start[n][1], array)
        _follow(meshes[n], motion.centre[:, n], motion.rotation[:, n], codes)
    bent = np.flatnonzero(~stiff)
    waiting = 0
    for done, (frame, code) in enumerate(zip(cut.frames, codes), 1):
        now = cut.surfaces(frame) if len(bent) else []
        for n in bent:
            vertices, normal = now[n]
            _shape(meshes[n], vertices, normal, array, code)
            waiting += 24 * len(vertices)
        if drops:
            now = cut.drops(frame)
            drops.GetPointsAttr().Set(array(now[:, :3]), code)
            drops.GetWidthsAttr().Set(Vt.FloatArray.FromNumpy((2.0 * now[:, 3]).astype(np.float32)), code)
            waiting += 16 * len(now)
        if waiting > FLUSH:
            _save(stage, stem)
            waiting = 0
        on_frame(done)
    _save(stage, stem)
    return [f"one time code is a frame, {rate:g} of them a second; lengths are metres, z is up"]


def _shape(mesh, vertices: np.ndarray, normal: np.ndarray, array: Callable, *code: float) -> None:
    """The surface at a time code, or at all times."""
    mesh.GetPointsAttr().Set(array(vertices), *code)
    mesh.GetNormalsAttr().Set(array(normal), *code)
    mesh.GetExtentAttr().Set(array([vertices.min(axis=0), vertices.max(axis=0)]), *code)


def _follow(mesh, centre: np.ndarray, rotation: np.ndarray, codes: np.ndarray) -> None:
    """Places, shape (F, 3), and quaternions, shape (F, 4), of a surface about its centre."""
    from pxr import Gf

    place, turn = mesh.AddTranslateOp(), mesh.AddOrientOp()
    for code, at, (*axis, w) in zip(codes, centre.tolist(), rotation.tolist()):
        place.Set(Gf.Vec3d(*at), code)
        turn.Set(Gf.Quatf(w, *axis), code)


def _free_name(wanted: str, used: set[str]) -> str:
    """A name that USD allows, unlike all names so far."""
    from pxr import Tf

    name = Tf.MakeValidIdentifier(wanted)
    while name in used:
        name += "_"
    used.add(name)
    return name


def linear(color: np.ndarray) -> np.ndarray:
    """Linear light, as USD wants colours, of colours as a screen shows them (sRGB), from 0 to 1."""
    return np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)


def _save(stage, stem: str) -> None:
    if not stage.GetRootLayer().Save():
        raise OSError(f"USD could not write {stem}.usdc")


def _material(stage, path: str, body: Body, Sdf, UsdShade):
    material, shader = UsdShade.Material.Define(stage, path), UsdShade.Shader.Define(stage, f"{path}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.1 if body.clear else 0.5)
    if body.clear:
        shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(OPACITY)
    color = shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    if body.paint is None:
        color.Set(tuple(map(float, linear(np.array(body.color)))))
    else:
        reader = UsdShade.Shader.Define(stage, f"{path}/paint")
        reader.CreateIdAttr("UsdPrimvarReader_float3")
        reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("displayColor")
        color.ConnectToSource(reader.CreateOutput("result", Sdf.ValueTypeNames.Float3))
    material.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("surface", Sdf.ValueTypeNames.Token))
    return material


def _lights(stage, render: Render) -> None:
    """The lamp and the sky of movies; without them a picture of Blender or usdview is dark."""
    from pxr import Gf, UsdLux

    lamp, sky = UsdLux.DistantLight.Define(stage, "/scene/lamp"), UsdLux.DomeLight.Define(stage, "/scene/sky")
    lamp.CreateIntensityAttr(SUN)
    lamp.CreateAngleAttr(2.0)
    lamp.CreateNormalizeAttr(True)  # else its brightness is that of a sun as small as its angle
    sky.CreateIntensityAttr(SKY)
    toward = np.array(render.light, float)  # a distant light shines along its -z
    view = View(toward, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    lamp.AddTransformOp().Set(Gf.Matrix4d(camera_matrix(view).tolist()))


def _camera(stage, cut: Cut, render: Render) -> None:
    """The camera of the scene, or the one that movies have without one."""
    from pxr import Gf, UsdGeom

    t = cut.trajectory
    width, height = render.size
    camera = UsdGeom.Camera.Define(stage, "/scene/camera")
    # Only the ratio of apertures and focal length counts; those of a film of 24 mm.
    camera.CreateVerticalApertureAttr(24.0)
    camera.CreateHorizontalApertureAttr(24.0 * width / height)
    camera.CreateFocalLengthAttr(12.0 / np.tan(np.radians(FIELD_OF_VIEW / 2)))
    place = camera.AddTransformOp()
    matrix = lambda view: Gf.Matrix4d(camera_matrix(view).tolist())
    path = camera_of(render.camera, t, action_of(t), width / height)
    views = [path.at(float(time)) for time in (cut.times[:1] if path.still else cut.times)]
    if path.still:
        place.Set(matrix(views[0]))
    else:
        for time, view in zip(cut.times, views):
            place.Set(matrix(view), time * cut.rate)
    far = max(float(np.linalg.norm(view.eye - view.look)) for view in views)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.001 * far, 100.0 * far))


def camera_matrix(view: View) -> np.ndarray:
    """From the camera, which looks along -z, to the scene; rows are its axes and its place, shape (4, 4)."""
    back = view.eye - view.look
    back = back / np.linalg.norm(back)
    right = np.cross(view.upright, back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:, :3] = right, np.cross(back, right), back, view.eye
    return matrix
