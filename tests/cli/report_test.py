# SPDX-License-Identifier: MIT
"""Is a report what its schema says, and is its page whole: one file that needs nothing else and takes no markup from an asset?"""

import base64
import html.parser
import json
import os
import re

import command
import gltf_file
from command import NOT_CONVERGED, ROOT

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None), "number": (int, float), "integer": int}


def faults(value, schema, at="report"):
    """What a value has against a schema: of JSON Schema what report.schema.json uses. A key that the schema has not is one too."""
    names = schema.get("type", [])
    names = [names] if isinstance(names, str) else names
    if names and not any(isinstance(value, TYPES[name]) and not (isinstance(value, bool) and name != "boolean") for name in names):
        yield f"{at}: {value!r} is not {names}"
        return
    if "enum" in schema and value not in schema["enum"]:
        yield f"{at}: {value!r} is none of {schema['enum']}"
    if isinstance(value, (int, float)) and not schema.get("minimum", value) <= value <= schema.get("maximum", value):
        yield f"{at}: {value} is out of range"
    if isinstance(value, str) and not re.search(schema.get("pattern", ""), value):
        yield f"{at}: {value!r} does not match"
    if isinstance(value, dict):
        yield from (f"{at}.{key} is missing" for key in schema.get("required", []) if key not in value)
        for key, inside in value.items():
            if key in schema["properties"]:
                yield from faults(inside, schema["properties"][key], f"{at}.{key}")
            else:
                yield f"{at}.{key} is not in the schema"
    if isinstance(value, list):
        for i, inside in enumerate(value):
            yield from faults(inside, schema["items"], f"{at}[{i}]")


class Page(html.parser.HTMLParser):
    """Which elements there are, what they load, and the data."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.loads, self.data, self.inside = [], [], "", False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.loads += [value for name, value in attributes if name in ("src", "href", "action")]
        self.inside = tag == "script" and ("type", "application/json") in attributes

    def handle_endtag(self, tag):
        self.inside = False

    def handle_data(self, data):
        if self.inside:
            self.data += data


def unlit_box():
    """Under the sky that is there where nothing else gives light."""
    scene = gltf_file.Scene()
    scene.add_mesh("box", gltf_file.box((0, 0, 0), (1, 1, 1)), scene.add_material("white", (0.7, 0.7, 0.7)))
    return scene


class Report(command.CommandCase):
    def setUp(self):
        super().setUp()
        with open(os.path.join(ROOT, "plugin/hosts/cli/report.schema.json")) as f:
            self.schema = json.load(f)

    def check(self, scene, *arguments, **more):
        self.write("scene.glb", scene.glb())
        self.bake("scene.glb", "out.glb", "--report", "r.json", *(arguments or ("--quality", "draft")), **more)
        report = json.loads(self.read("r.json"))
        self.assertEqual(list(faults(report, self.schema)), [])
        return report

    def test_reports_are_what_the_schema_says(self):
        self.check(gltf_file.room())
        self.check(gltf_file.room(), "--quality", "draft", "--scene-linear", "--no-draco")
        self.check(gltf_file.room(), "--quality", "draft", "--method", "rows")
        self.check(gltf_file.room(), "--quality", "draft", "--time", "1e-3", status=NOT_CONVERGED)
        dark = self.check(unlit_box())
        self.assertTrue(dark["arrived"]["sky_by_default"])
        self.assertIn("warning: nothing in the scene emits light; a sky of radiance 1 lights it", dark["warnings"])

    def test_the_schema_can_fail(self):
        report = self.check(gltf_file.room())
        self.assertEqual(self.schema["$schema"], "https://json-schema.org/draft/2020-12/schema")
        for change in (lambda r: r.pop("energy"), lambda r: r["scene"].update(patches=-1), lambda r: r["scene"].update(patches="7"),
                       lambda r: r["solver"].update(method="magic"), lambda r: r["hemibake"].update(report_sha256="x"),
                       lambda r: r["solver"].update(converged=1), lambda r: r["curve"].append({}), lambda r: r.update(news=1)):
            broken = json.loads(json.dumps(report))
            change(broken)
            self.assertTrue(list(faults(broken, self.schema)))

    def test_the_curve_says_how_the_error_fell_by_either_method(self):
        for method in ("hybrid", "rows"):
            report = self.check(gltf_file.room(), "--quality", "draft", "--method", method)
            times, errors = zip(*((p["t_s"], p["error_estimate"]) for p in report["curve"]))
            print(f"{method}: " + ", ".join(f"{t:.2f} s {e:.1%}" for t, e in zip(times, errors)))
            self.assertGreater(len(times), 3)
            self.assertEqual(list(times), sorted(times))
            self.assertLess(times[-1], report["time"]["total_s"])
            self.assertGreaterEqual(errors[0], 1.0)
            self.assertAlmostEqual(errors[-1], report["error"]["estimate"], places=6)
            self.assertLess(errors[-1], 0.5 * errors[1])

    def test_bakes_that_led_to_one_have_their_time(self):
        alone = self.check(gltf_file.room())["time"]
        self.assertLess(alone["earlier_s"], 0.1 * alone["total_s"])
        led = self.check(gltf_file.room(), "--error", "1%")["time"]
        parts = sum(s for name, s in led.items() if name not in ("total_s", "processor_s"))
        self.assertGreater(led["earlier_s"], 0.05)
        self.assertAlmostEqual(parts, led["total_s"], delta=0.1 * led["total_s"])

    def test_what_is_noted_is_in_the_report_of_a_quiet_bake_too(self):
        self.assertEqual(len(self.check(unlit_box(), "-q", "--quality", "draft")["warnings"]), 1)

    def test_the_page_is_one_file_with_the_report_and_two_pictures(self):
        self.write("scene.glb", gltf_file.room().glb())
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--report", "r.html")
        text = self.read("r.html").decode()
        page = Page(text)
        self.assertLess(len(text), 2e6)
        self.assertEqual(page.loads, [])
        self.assertNotRegex(text.replace("/*! https://github.com/leeoniya/uPlot", ""), r"https?://|@import|url\(")
        data = json.loads(page.data)
        self.assertEqual(list(faults(data["report"], self.schema)), [])
        for name in ("before", "after"):
            self.assertTrue(base64.b64decode(data[name], validate=True).startswith(b"\xff\xd8\xff"))
        self.assertNotEqual(data["before"], data["after"])
        self.assertIn(["--quality", "draft"], data["options"])
        # Those that were not given too, with what they are then; none twice.
        left = dict(data["defaults"])
        self.assertIn("default 4000000", left["--max-elements"])
        self.assertFalse(set(left) & {name for name, _ in data["options"]})
        help_of_bake = self.succeed("help", "bake").stdout
        self.assertEqual(set(left) | {name for name, _ in data["options"]}, set(re.findall(r"^  (-[-\w]+)", help_of_bake, re.M)))
        self.assertEqual(sum(count for _, count in data["sizes"]), data["report"]["scene"]["triangles_out"])

    def before(self, pixel):
        """The page's picture of the input, the room with a texture of four texels, or none, on its walls."""
        scene = gltf_file.room()
        if pixel:
            image = gltf_file.png(2, 2, pixel)
            scene.json["bufferViews"].append({"buffer": 0, "byteOffset": len(scene.bin), "byteLength": len(image)})
            scene.bin += image + bytes(-len(image) % 4)
            scene.json["images"] = [{"bufferView": len(scene.json["bufferViews"]) - 1, "mimeType": "image/png"}]
            scene.json["textures"] = [{"source": 0}]
            scene.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
            scene.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = scene._add_accessor(
                [[0, 0], [1, 0], [1, 1], [0, 1]] * 2, "VEC2", gltf_file.FLOAT)
        self.write("scene.glb", scene.glb())
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--report", "r.html")
        return json.loads(Page(self.read("r.html").decode()).data)["before"]

    def test_the_picture_before_shows_textures(self):
        plain, white = self.before(None), self.before(lambda y, x: (255, 255, 255))
        half = self.before(lambda y, x: (255 * (x > 0), 255, 255))
        self.assertEqual(plain, white)
        self.assertNotEqual(plain, half)

    def test_the_picture_before_shows_lamps_that_shine(self):
        def picture(radiance):
            self.write("scene.glb", gltf_file.room((radiance,) * 3).glb())
            self.bake("scene.glb", "out.glb", "--quality", "draft", "--look-from", "0.9,0.4,0.9", "--report", "r.html")
            return json.loads(Page(self.read("r.html").decode()).data)["before"]

        self.assertNotEqual(picture(0.1), picture(10.0))
        self.assertEqual(picture(10.0), picture(20.0))

    def test_the_picture_before_is_as_smooth_as_the_normals(self):
        """With them a sphere is round, of which light by facets and a file without normals know nothing."""
        seen = {}
        for name, has_normals, normals in (("smooth", True, "file"), ("facets", True, "faces"), ("bare", False, "file")):
            scene = gltf_file.room()
            sphere = gltf_file.sphere(8, (0, 1.2, 0), 0.4)
            scene.add_mesh("sphere", sphere if has_normals else sphere[:2], scene.add_material("grey", (0.5, 0.5, 0.5)))
            self.write("s.glb", scene.glb())
            self.bake("s.glb", "o.glb", "--report", "r.html", "--quality", "draft", "--normals", normals)
            seen[name] = json.loads(Page(self.read("r.html").decode()).data)["before"]
        self.assertEqual(seen["facets"], seen["bare"])
        self.assertNotEqual(seen["facets"], seen["smooth"])

    def test_no_markup_of_a_stranger_gets_into_the_page(self):
        scene = gltf_file.room()
        scene.json["materials"][0]["name"] = "</script><img src=x onerror=alert(1)>"
        scene.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [1, 1, 1, 1]
        self.write("a<b>&.glb", scene.glb())
        self.bake("a<b>&.glb", "out.glb", "--quality", "draft", "--report", "evil.html")
        page = Page(self.read("evil.html").decode())
        self.assertEqual(page.tags.count("img"), 0)
        data = json.loads(page.data)
        self.assertEqual(data["report"]["input"]["path"], "a<b>&.glb")
        self.assertTrue(any("</script><img" in line for line in data["report"]["warnings"]), data["report"]["warnings"])


if __name__ == "__main__":
    command.main()
