# SPDX-License-Identifier: MIT
"""Is a sky of OpenEXR the sky that it holds, however it is stored; and is one that cannot be read refused by one line? Measured on the
radiance that comes out, against the same sky as Radiance's .hdr."""

import os
import resource

from command import BAD_INPUT, CommandCase, main
from exr_file import FLOAT, HALF, UINT, Part, of_colors, picture
from gltf_file import Asset, Scene, box
from light_test import floor, hdr

SIZE = (32, 16)


def sky(row, column):
    """Brighter above, and in the west; of .hdr's mantissas and of halves all exact."""
    return (4 if row < 5 else 1), 2, (8 if column < 9 else 2)


def channel(k, kind=HALF):
    return kind, lambda x, y: sky(y, x)[k]


WINDOW = (0, 0, SIZE[0] - 1, SIZE[1] - 1)


class Skies(CommandCase):
    def radiance(self, name, data, *options):
        """Of the vertices of a box, lit by the sky alone."""
        scene = Scene()
        scene.add_mesh("box", box((-1, -1, -1), (1, 1, 1)), scene.add_material("dark", (0.05, 0.05, 0.05)))
        self.write("in.glb", scene.glb())
        self.write(name, data)
        self.said = self.bake("in.glb", "out.glb", "--scene-linear", "--no-draco", "--quality", "draft", "--method", "rows", "--element-size", "1",
                              "--environment", name, *options).stderr
        asset = Asset(self.path("out.glb"))
        attributes = asset.json["meshes"][0]["primitives"][0]["attributes"]
        return list(zip(asset.values(attributes["POSITION"]), asset.values(attributes["_RADIOSITY"])))

    def setUp(self):
        super().setUp()
        self.truth = self.radiance("sky.hdr", hdr(*SIZE, sky))
        values = [c for _, light in self.truth for c in light]
        self.assertGreater(max(values), 3 * min(values))  # or no picture could be told from another

    def check(self, data, note="", name="sky.exr"):
        self.assertEqual(self.radiance(name, data), self.truth)
        self.assertEqual(self.said, f"hemibake: in.glb: --environment {name}: {note}\n" if note else "")

    def test_it_is_the_sky_of_the_same_picture_as_hdr(self):
        for kind in (HALF, FLOAT, UINT):
            for compression in ("none", "zips", "zip"):
                for tile in (0, 12):
                    self.check(of_colors(*SIZE, sky, kind, compression=compression, tile=tile))

    def test_its_content_says_what_it_is_and_not_its_name(self):
        self.check(of_colors(*SIZE, sky), name="sky.hdr")
        self.check(hdr(*SIZE, sky), name="sky.exr")

    def test_a_sky_of_two_windows_is_black_outside_of_its_data(self):
        top = (0, 0, SIZE[0] - 1, 5)
        black = self.radiance("half.hdr", hdr(*SIZE, lambda row, column: sky(row, column) if row <= 5 else (0, 0, 0)))
        self.assertNotEqual(black, self.truth)
        for tile in (0, 8):
            part = Part({name: channel(k) for k, name in enumerate("RGB")}, top, WINDOW, tile=tile)
            self.assertEqual(self.radiance("half.exr", picture(part)), black)
        wide = Part({name: channel(k) for k, name in enumerate("RGB")}, (-5, -4, SIZE[0] + 3, SIZE[1] + 7), WINDOW)
        self.check(picture(wide))

    def test_of_many_parts_and_layers_one_is_read_and_named(self):
        colors = {name: channel(k) for k, name in enumerate("RGB")}
        named = {"sky." + name: channel(k) for k, name in enumerate("RGB")}
        depth = {"Z": (FLOAT, lambda x, y: 1)}
        other = {name: (HALF, lambda x, y: 9) for name in "RGB"}
        self.check(picture(Part({**colors, **depth, "A": (HALF, lambda x, y: 1)}, WINDOW)))
        self.check(picture(Part({**named, **depth}, WINDOW)), 'layer "sky" is read')
        self.check(picture(Part({**colors, "a.Y": (HALF, lambda x, y: 9)}, WINDOW)), "it has 2 sets of colours; the one without a name is read")
        self.check(picture(Part(depth, WINDOW, name="depth"), Part(colors, WINDOW, name="beauty")))
        self.check(picture(Part(depth, WINDOW, name="depth"), Part(colors, WINDOW, name="beauty", tile=8), Part(other, WINDOW, name="other")),
                   'it has 2 sets of colours; part "beauty" is read')
        # What is stored at a part of the pixels alone, before and behind the colours of a row.
        self.check(picture(Part({**colors, "A": (HALF, lambda x, y: 1, 2), "Z": (FLOAT, lambda x, y: 1, 4)}, WINDOW)))

    def test_what_is_no_light_is_black_as_in_hdr_and_told(self):
        def spoilt(row, column):
            red, green, blue = sky(row, column)
            return (float("inf") if (row, column) == (3, 4) else red), (-1 if row == 7 else green), (float("nan") if row == 9 else blue)

        def mended(row, column):
            return tuple(c if 0 <= c < 1e9 else 0 for c in spoilt(row, column))
        self.truth = self.radiance("mended.hdr", hdr(*SIZE, mended))
        self.check(of_colors(*SIZE, spoilt), "65 of its values are negative or not finite, and taken as 0")
        self.check(of_colors(*SIZE, spoilt, FLOAT), "65 of its values are negative or not finite, and taken as 0")


class BadSkies(CommandCase):
    def refuse(self, data, says, *options):
        self.write("in.glb", floor().glb())
        self.write("sky.exr", data)
        ran = self.run_hemibake("bake", "in.glb", "-o", "out.glb", "--quality", "draft", "--environment", "sky.exr", *options)
        self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
        self.assertEqual(ran.stderr, f"hemibake: sky.exr: --environment: {says}; it takes R,G,B or a panorama as .hdr or .exr\n")
        self.assertFalse(os.path.exists(self.path("out.glb")))

    def test_what_cannot_be_read_is_one_line_that_says_why(self):
        colors = {name: channel(k) for k, name in enumerate("RGB")}
        thin = {"Y": channel(0), "RY": (HALF, lambda x, y: 1, 2), "BY": (HALF, lambda x, y: 1, 2)}
        chroma = "it has luminance and chroma, or colours at a part of its pixels; write it as R, G and B"
        for part, says in (
                (Part(thin, WINDOW), chroma),
                (Part({**colors, "B": (HALF, lambda x, y: 1, 2)}, WINDOW), chroma),
                (Part({"Z": channel(0)}, WINDOW), "it has no channels R, G and B, and no Y"),
                (Part(colors, WINDOW, compression="zips", kind="deepscanline"), "it is deep, with any number of samples a pixel; flatten it"),
                (Part(colors, WINDOW, compression="dwaa"), "its pixels are malformed or cut short"),
                (Part(colors, WINDOW, attributes=[("envmap", "envmap", b"\1")]), "it is a cube map; write it by longitude and latitude"),
                (Part(colors, WINDOW, (0, 0, 99999, 3)), "it has more than 2^27 pixels, or a side above 65536"),
                (Part(colors, WINDOW, (100, 100, 109, 109)), "its data window is outside of its display window")):
            self.refuse(picture(part), says)

    def test_a_small_file_that_asks_for_much_is_refused_before_it_has_it(self):
        """A row of 50 pixels says that it is one of many."""
        small = of_colors(50, 1, lambda row, column: (1, 1, 1), compression="none")
        for width, height in ((65536, 2048), (16384, 8192)):
            window = b"box2i\0\x10\0\0\0" + bytes(8)
            data = small.replace(window + bytes([49, 0, 0, 0, 0, 0, 0, 0]), window + (width - 1).to_bytes(4, "little") + (height - 1).to_bytes(4, "little"))
            self.assertNotEqual(data, small)
            self.refuse(data, "its pixels are malformed or cut short (OpenEXR: Invalid argument to function)")
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 1 << 20)  # KiB; the picture would be 1.5 GiB

    def test_what_is_cut_off_or_damaged_is_refused(self):
        whole = of_colors(*SIZE, sky)
        for kept in (4, 40, 200, len(whole) - 1):
            self.write("in.glb", floor().glb())
            self.write("sky.exr", whole[:kept])
            ran = self.run_hemibake("bake", "in.glb", "-o", "out.glb", "--environment", "sky.exr")
            self.assertEqual((ran.returncode, ran.stderr.count("\n")), (BAD_INPUT, 1), ran.stderr)
            self.assertIn("malformed or cut short (OpenEXR: ", ran.stderr)
        short = of_colors(*SIZE, sky, compression="none").replace(b"\0\0\0\0\xc0\0\0\0", b"\0\0\0\0\xbf\0\0\0", 1)
        self.assertNotIn(b"\0\0\0\0\xc0\0\0\0", short)  # its first row says that it is a byte shorter
        self.refuse(short, "its pixels are malformed or cut short (OpenEXR: Corrupt data block data, unable to decode)")
        data = whole[:-20] + bytes(20)
        self.refuse(data, "its pixels are malformed or cut short (OpenEXR: Corrupt data block data, unable to decode)")

    def test_the_root_confines_it(self):
        os.mkdir(self.path("asset"))
        self.write("asset/in.glb", floor().glb())
        for name in ("sky.exr", "asset/sky.exr"):
            self.write(name, of_colors(*SIZE, sky))
            ran = self.run_hemibake("bake", "asset/in.glb", "-o", "out.glb", "--quality", "draft", "--root", "asset", "--environment", name)
            self.assertEqual((ran.returncode, "outside of the folder" in ran.stderr), (BAD_INPUT, True) if name == "sky.exr" else (0, False), ran.stderr)


if __name__ == "__main__":
    main()
