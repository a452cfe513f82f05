# SPDX-License-Identifier: MIT
"""Do options that steer the light do what they say: bounces, ambient occlusion, the scale of what emits?

A closed box whose walls emit L and reflect rho shows, after N bounces, L (1 + rho + ... + rho^(N + 1)).
"""

import json

from command import BAD_INPUT, CommandCase, main
from gltf_file import Asset, Scene, box

L, RHO = 2.0, 0.5


def furnace():
    scene = Scene()
    scene.add_mesh("walls", box((0, 0, 0), (3, 2, 2), inward=True), scene.add_material("wall", (RHO,) * 3, (L,) * 3))
    return scene


def floor_and_ceiling(gap):
    """Two wide plates, one over the other; the lower is the first mesh."""
    scene = Scene()
    grey = scene.add_material("grey", (0.1, 0.1, 0.1))
    low = [[-5, 0, -5], [-5, 0, 5], [5, 0, 5], [5, 0, -5]]
    scene.add_mesh("floor", (low, [(0, 1, 2), (0, 2, 3)]), grey)
    scene.add_mesh("ceiling", ([[x, gap, z] for x, _, z in low], [(0, 2, 1), (0, 3, 2)]), grey)
    return scene


class Steering(CommandCase):
    def radiance(self, scene, *options):
        """[(position, radiance)] of the first mesh."""
        self.write("in.glb", scene.glb())
        self.ran = self.bake("in.glb", "out.glb", "--scene-linear", "--no-draco", "--merge-error", "0", "--quality", "draft",
                             "--element-size", "0.4", "--report", "report.json", *options)
        asset = Asset(self.path("out.glb"))
        attributes = asset.json["meshes"][0]["primitives"][0]["attributes"]
        return list(zip(asset.values(attributes["POSITION"]), asset.values(attributes["_RADIOSITY"])))

    def test_bounces_are_the_terms_of_the_series(self):
        for options, terms in ((["--direct-only"], 1), (["--bounces", "0"], 1), (["--bounces", "2"], 3)):
            expected = L * sum(RHO**k for k in range(terms + 1))
            found = [radiance[0] for _, radiance in self.radiance(furnace(), *options)]
            # Of one vertex the rays to emitters, eight at draft, are as noisy as the corner beside it is near.
            self.assertAlmostEqual(sum(found) / len(found), expected, delta=0.02 * expected, msg=options)
            report = json.loads(self.read("report.json"))
            self.assertEqual(report["solver"]["method"], "rows")
            self.assertLess(report["energy"]["residual_fraction"], 1e-4)
            # The next bounces would be half of the light and more; nobody asked for them.
            self.assertLess(report["error"]["estimate"], 0.3)

    def test_methods_that_cannot_count_bounces_say_so(self):
        self.write("in.glb", floor_and_ceiling(1).glb())
        for options in (["--bounces", "1", "--method", "hybrid"], ["--ao", "--method", "hybrid"]):
            ran = self.run_hemibake("bake", "in.glb", "-o", "out.glb", *options)
            self.assertEqual(ran.returncode, BAD_INPUT)
            self.assertEqual(len(ran.stderr.splitlines()), 1)
            self.assertIn("method rows", ran.stderr)
        self.assertEqual(self.left(), ["in.glb"])

    def test_what_emits_is_scaled(self):
        once, twice = (self.radiance(furnace(), "--emissive-scale", x) for x in ("1", "2.5"))
        for (_, a), (_, b) in zip(once, twice):
            self.assertAlmostEqual(b[0], 2.5 * a[0], delta=1e-4 * b[0])

    def test_ambient_occlusion_is_the_share_of_the_sky_that_is_seen(self):
        def middle(gap, *options):
            found = self.radiance(floor_and_ceiling(gap), "--ao", *options)
            return min(found, key=lambda v: v[0][0] ** 2 + v[0][2] ** 2)[1][0]

        # Half a metre below a plate of ten only a rim of the sky is seen; past what is near, all of it.
        self.assertLess(middle(0.5, "--ao-distance", "100"), 0.02)
        self.assertAlmostEqual(middle(0.5, "--ao-distance", "0.4"), 1.0, delta=1e-3)
        # A plate at height h is hit within d where cos > h / d: what is seen is (h / d)^2.
        self.assertAlmostEqual(middle(0.5, "--ao-distance", "1"), 0.25, delta=0.03)
        # The diagonal is 14.2 m; a tenth of it reaches far enough.
        self.assertAlmostEqual(middle(0.5), (0.5 / 1.4151) ** 2, delta=0.03)
        asset = Asset(self.path("out.glb"))
        colors = asset.values(asset.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"])
        self.assertLess(max(c[0] for c in colors), 65536)


if __name__ == "__main__":
    main()
