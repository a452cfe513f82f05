# SPDX-License-Identifier: MIT
"""Is what hemibake writes as USD valid, with the colours of the bake, and is the input left alone?"""

import hashlib
import json
import subprocess
import sys

from command import main
from gltf_file import Asset
from usd_file import SKY, UsdCase, primitives, quad

# What is in a stage, from a process of its own: pxr and its threads stay out of the tests.
DESCRIBE = r"""
import json, sys
from pxr import Gf, Usd, UsdGeom, UsdShade, UsdValidation
def opacities(prim):
    # Of the mesh, and of the material it shows.
    shown = UsdGeom.Gprim(prim).GetDisplayOpacityAttr().Get()
    surface = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0].ComputeSurfaceSource()[0] if shown else None
    put = surface.GetInput('opacity') if surface else None
    return [shown[0], put.Get()] if put else []
stage = Usd.Stage.Open(sys.argv[1])
for choice in sys.argv[2:]:
    for prim in stage.GetPseudoRoot().GetChildren():
        if 'hemibake' in prim.GetVariantSets().GetNames():
            prim.GetVariantSets().SetSelection('hemibake', choice)
faults = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators()).Validate(stage)
meshes, lights, seen, instancers = {}, [], [], []
for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
    if prim.IsA(UsdGeom.Mesh):
        mesh = UsdGeom.Mesh(prim)
        world = mesh.ComputeLocalToWorldTransform(Usd.TimeCode.EarliestTime())
        primvars = UsdGeom.PrimvarsAPI(prim)
        radiance = primvars.GetPrimvar('hemibake:radiance').Get() if primvars.HasPrimvar('hemibake:radiance') else None
        meshes[str(prim.GetPath())] = {
            'points': [list(world.Transform(Gf.Vec3d(p))) for p in mesh.GetPointsAttr().Get()],
            'colors': [list(c) for c in mesh.GetDisplayColorAttr().Get() or []],
            'radiance': [list(c) for c in radiance] if radiance else [],
            'opacity': opacities(prim),
        }
        if mesh.ComputeVisibility() != 'invisible' and mesh.ComputePurpose() != 'guide':
            seen.append(str(prim.GetPath()))
    elif prim.IsA(UsdGeom.PointInstancer):
        instancers.append(str(prim.GetPath()))
    elif 'Light' in prim.GetTypeName():
        lights.append(str(prim.GetPath()))
print(json.dumps({'errors': [e.GetMessage() for e in faults], 'meshes': meshes, 'lights': lights, 'seen': seen, 'instancers': instancers, 'data': stage.GetRootLayer().customLayerData}))
"""


def describe(path, *choice):
    ran = subprocess.run([sys.executable, "-c", DESCRIBE, path, *choice], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)


class Stage(UsdCase):
    def setUp(self):
        super().setUp()
        self.scene = self.stage(quad("Floor", half=50) + 'def Xform "In" {' + quad("Part", half=5, y=10, color="(0.8, 0.2, 0.1)") + "}\n" + SKY, meters=0.01, up="Z")

    def bake_to(self, name, *options):
        return self.bake(self.scene, name, "--quality", "draft", *options)

    def test_every_kind_of_stage_is_valid_and_says_what_the_glb_says(self):
        self.bake_to("out.glb", "--scene-linear", "--no-draco")
        asset = Asset(self.path("out.glb"))
        for name in ("out.usda", "out.usdc", "out.usdz"):
            self.bake_to(name, "--scene-linear")
            found = describe(self.path(name))
            self.assertEqual(found["errors"], [])
            for path, primitive in primitives(asset):
                mesh = found["meshes"]["/Baked" + path]
                self.assertEqual(mesh["radiance"], [list(row) for row in asset.values(primitive["attributes"]["_RADIOSITY"])])
                for color, radiance in zip(mesh["colors"], mesh["radiance"]):
                    self.assertEqual(color, [min(max(v, 0.0), 1.0) for v in radiance])
            self.assertEqual(found["data"]["hemibake"]["options"]["quality"], "draft")

    def test_same_bake_same_bytes(self):
        for name in ("a.usda", "b.usda", "a.usdc", "b.usdc", "a.usdz"):
            self.bake_to(name)
        self.assertEqual(self.read("a.usda"), self.read("b.usda"))
        self.assertEqual(self.read("a.usdc"), self.read("b.usdc"))
        # What is in a package is called after it.
        first = self.read("a.usdz")
        self.bake_to("a.usdz")
        self.assertEqual(first, self.read("a.usdz"))

    def test_a_layer_switches_between_the_bake_and_the_untouched_stage(self):
        before = hashlib.sha256(self.read("stage.usda")).hexdigest()
        self.bake_to("baked.usdc", "--layer", "over.usda")
        self.assertEqual(hashlib.sha256(self.read("stage.usda")).hexdigest(), before)
        source, baked, given = describe(self.path("over.usda"), "source"), describe(self.path("over.usda")), describe(self.path("stage.usda"))
        self.assertEqual((source["errors"], baked["errors"]), ([], []))
        self.assertEqual((source["meshes"], source["lights"]), (given["meshes"], given["lights"]))
        self.assertEqual(baked["lights"], [])
        self.assertEqual(sorted(baked["meshes"]), ["/World/HemibakeBaked/World/Floor", "/World/HemibakeBaked/World/In/Part"])
        for name in ("Floor", "In/Part"):
            mine, theirs = (sorted(map(tuple, m["meshes"][p]["points"])) for m, p in ((baked, f"/World/HemibakeBaked/World/{name}"), (given, f"/World/{name}")))
            for k in range(3):
                for pick in (min, max):
                    self.assertAlmostEqual(pick(p[k] for p in mine), pick(p[k] for p in theirs), places=3)

    def test_a_layer_alone_names_its_payload(self):
        self.succeed("bake", self.scene, "--layer", "over.usda", "--quality", "draft")
        self.assertIn("over.baked.usdc", self.left())
        self.assertEqual(describe(self.path("over.usda"))["errors"], [])


class Layer(UsdCase):
    def test_what_stands_at_the_root_or_says_that_it_is_active_is_put_aside_and_comes_back(self):
        head = '#usda 1.0\n(\n defaultPrim = "A"\n metersPerUnit = 1\n)\n'
        body = quad("A") + quad("B", y=1).replace('"B" {', '"B" (\nactive = true\n) {') + quad("C", 'token visibility = "inherited"', y=2) + SKY
        scene = self.write("stage.usda", (head + body).encode())
        self.succeed("bake", scene, "--layer", "over.usda", "--quality", "draft")
        source, given = describe(self.path("over.usda"), "source"), describe(scene)
        self.assertEqual({name: source["meshes"].get(name) for name in given["meshes"]}, given["meshes"])
        self.assertEqual(sorted(source["meshes"]), ["/A", "/B", "/C"])
        self.assertEqual(sorted(describe(self.path("over.usda"))["seen"]), [f"/HemibakeBaked/{name}" for name in "ABC"])

    def test_an_instancer_of_instancers_or_of_lamps_is_put_aside(self):
        inner = 'def PointInstancer "Inner" {\nrel prototypes = [</World/Outer/Inner/A>]\nint[] protoIndices = [0]\npoint3f[] positions = [(0, 0, 0)]\n' + quad("A") + "}\n"
        outer = 'def PointInstancer "Outer" {\nrel prototypes = [</World/Outer/Inner>]\nint[] protoIndices = [0, 0]\npoint3f[] positions = [(0, 0, 0), (1, 0, 0)]\n' + inner + "}\n"
        lamps = 'def PointInstancer "Lamps" {\nrel prototypes = [</World/Lamps/L>]\nint[] protoIndices = [0]\npoint3f[] positions = [(0, 2, 0)]\ndef SphereLight "L" {}\n}\n'
        self.succeed("bake", self.stage(outer + lamps), "--layer", "over.usda", "--quality", "draft")
        self.assertEqual(describe(self.path("over.usda"))["instancers"], [])
        self.assertEqual(len(describe(self.path("over.usda"), "source")["instancers"]), 3)

    def test_what_cannot_be_put_aside_is_told(self):
        stubborn = quad("A", 'token visibility = "inherited"\nuniform token purpose = "default"').replace('"A" {', '"A" (\nactive = true\n) {')
        ran = self.succeed("bake", self.stage(stubborn + SKY), "--layer", "over.usda", "--quality", "draft")
        self.assertIn("/World/A: stands beside the bake", ran.stderr)

    def test_glass_stays_glass(self):
        look = """def Material "Pane" {
            token outputs:surface.connect = </World/Pane/S.outputs:surface>
            def Shader "S" {
                uniform token info:id = "UsdPreviewSurface"
                float inputs:opacity = 0.25
                token outputs:surface
            }
        }
        """
        body = quad("Glass", "rel material:binding = </World/Pane>", y=1) + look + quad("Thin", "float[] primvars:displayOpacity = [0.5]", y=2) + quad("Floor") + SKY
        self.bake(self.stage(body), "out.usda", "--quality", "draft")
        found = describe(self.path("out.usda"))
        self.assertEqual(found["errors"], [])
        self.assertEqual({path.rsplit("/", 1)[-1]: mesh["opacity"] for path, mesh in found["meshes"].items()}, {"Glass": [0.25, 0.25], "Thin": [0.5, 0.5], "Floor": []})


class Hostile(UsdCase):
    def test_a_broken_stage_is_one_line(self):
        stage = self.stage(quad("A") + SKY)
        with open(stage, "rb") as f:
            good = f.read()
        for k in range(12):
            at = len(good) * k // 12
            self.write("broken.usda", good[:at] if k % 2 else good[:at] + b"\x00{(" + good[at + 5 :])
            ran = self.run_hemibake("bake", "broken.usda", "-o", "out.glb", "--quality", "draft", "--quiet")
            if ran.returncode:
                self.assertEqual(len(ran.stderr.splitlines()), 1, ran.stderr)


if __name__ == "__main__":
    main()
