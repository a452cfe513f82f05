# SPDX-License-Identifier: MIT
"""Writes hall.usda: a hall with a row of columns that are instances, tiles by a PointInstancer, a lamp, a sun, a sky, and a variant set
that dims the lamp. Units are centimetres and z is up, as many stages have it.

    python3 samples/usd/hall.py hall.usda
    hemibake bake hall.usda -o hall.glb --quality draft --preview hall.png
    hemibake bake hall.usda -o hall.usdc --layer hall.baked.usda --variant '/Hall/Lights{time=night}'
"""

import sys

from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdLux, UsdShade, Vt


def material(stage, name, color):
    out = UsdShade.Material.Define(stage, f"/Hall/Looks/{name}")
    surface = UsdShade.Shader.Define(stage, f"/Hall/Looks/{name}/Surface")
    surface.CreateIdAttr("UsdPreviewSurface")
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*color))
    surface.CreateOutput("surface", Sdf.ValueTypeNames.Token)
    out.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    return out


def bind(prim, look):
    UsdShade.MaterialBindingAPI.Apply(prim.GetPrim()).Bind(look)


def slab(stage, path, low, high, look):
    """A box between two corners, in centimetres."""
    mesh = UsdGeom.Mesh.Define(stage, path)
    points = [Gf.Vec3f(*((low, high)[corner >> k & 1][k] for k in range(3))) for corner in range(8)]
    mesh.CreatePointsAttr(points)
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    mesh.CreateFaceVertexIndicesAttr([0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5])
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateExtentAttr([points[0], points[7]])
    bind(mesh, look)


def hall(stage, white, red):
    slab(stage, "/Hall/Floor", (-400, -250, -10), (400, 250, 0), white)
    slab(stage, "/Hall/Back", (-400, 250, 0), (400, 260, 300), white)
    slab(stage, "/Hall/Left", (-410, -250, 0), (-400, 260, 300), red)
    slab(stage, "/Hall/Ceiling", (-410, -50, 300), (400, 260, 310), white)


def columns(stage, white):
    """One prototype that is a class, five instances of it."""
    stage.CreateClassPrim("/Hall/Column_")
    shaft = UsdGeom.Cylinder.Define(stage, "/Hall/Column_/Shaft")
    shaft.CreateRadiusAttr(18)
    shaft.CreateHeightAttr(300)
    shaft.CreateExtentAttr([(-18, -18, -150), (18, 18, 150)])
    shaft.AddTranslateOp().Set(Gf.Vec3d(0, 0, 150))
    bind(shaft, white)
    for i in range(5):
        column = UsdGeom.Xform.Define(stage, f"/Hall/Column_{i}")
        column.GetPrim().GetReferences().AddInternalReference("/Hall/Column_")
        column.GetPrim().SetInstanceable(True)
        column.AddTranslateOp().Set(Gf.Vec3d(-300 + 150 * i, -20, 0))


def stones(stage, red):
    many = UsdGeom.PointInstancer.Define(stage, "/Hall/Stones")
    stone = UsdGeom.Cube.Define(stage, "/Hall/Stones/Prototypes/Stone")
    stone.CreateSizeAttr(30)
    stone.CreateExtentAttr([(-15, -15, -15), (15, 15, 15)])
    bind(stone, red)
    many.CreatePrototypesRel().SetTargets([stone.GetPath()])
    places = [(-250 + 90 * i, 120 + 40 * (i % 2), 15) for i in range(6)]
    many.CreateProtoIndicesAttr([0] * len(places))
    many.CreatePositionsAttr([Gf.Vec3f(*place) for place in places])
    turns = [Gf.Rotation(Gf.Vec3d(0, 0, 1), 20 * i).GetQuat() for i in range(len(places))]
    many.CreateOrientationsAttr(Vt.QuathArray([Gf.Quath(q) for q in turns]))


def lights(stage):
    """Day: sun and sky. Night: the lamp alone."""
    group = UsdGeom.Xform.Define(stage, "/Hall/Lights")
    lamp = UsdLux.RectLight.Define(stage, "/Hall/Lights/Lamp")
    lamp.CreateWidthAttr(120)
    lamp.CreateHeightAttr(60)
    lamp.CreateIntensityAttr(2000)
    lamp.AddTranslateOp().Set(Gf.Vec3d(150, 120, 295))
    times = group.GetPrim().GetVariantSets().AddVariantSet("time")
    for name in ("day", "night"):
        times.AddVariant(name)
    times.SetVariantSelection("day")
    with times.GetVariantEditContext():
        sky = UsdLux.DomeLight.Define(stage, "/Hall/Lights/Sky")
        sky.CreateIntensityAttr(300)
        sky.CreateColorAttr(Gf.Vec3f(0.6, 0.8, 1.0))
        sun = UsdLux.DistantLight.Define(stage, "/Hall/Lights/Sun")
        sun.CreateIntensityAttr(4e7)
        sun.AddRotateXYZOp().Set(Gf.Vec3f(50, 0, -30))
    times.SetVariantSelection("night")
    with times.GetVariantEditContext():
        lamp.GetColorTemperatureAttr().Set(3000)
        lamp.GetEnableColorTemperatureAttr().Set(True)
    times.SetVariantSelection("day")


def main():
    stage = Usd.Stage.CreateNew(sys.argv[1] if len(sys.argv) > 1 else "hall.usda")
    root = UsdGeom.Xform.Define(stage, "/Hall")
    stage.SetDefaultPrim(root.GetPrim())
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.Scope.Define(stage, "/Hall/Looks")
    white, red = material(stage, "White", (0.75, 0.75, 0.72)), material(stage, "Red", (0.6, 0.15, 0.1))
    hall(stage, white, red)
    columns(stage, white)
    stones(stage, red)
    lights(stage)
    camera = UsdGeom.Camera.Define(stage, "/Hall/Camera")
    camera.CreateFocalLengthAttr(24)
    camera.AddTranslateOp().Set(Gf.Vec3d(150, -750, 170))
    camera.AddRotateXYZOp().Set(Gf.Vec3f(88, 0, 8))
    stage.GetRootLayer().Save()


main()
