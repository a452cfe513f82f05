# SPDX-License-Identifier: MIT
"""Where does fuzzing begin? Small valid files of each kind into a folder, one file name TARGET-NAME each: seeds.py FOLDER"""

import base64
import json
import os
import random
import struct
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
import command  # noqa: E402
import exr_file  # noqa: E402
import gltf_file  # noqa: E402

IES = """IESNA:LM-63-2002
TILT=NONE
1 1000 1 3 2 1 2 0 0 0
1 1 100
0 45 90
0 180
100 80 0
90 70 0
"""

# Four files of 12 x 6 pixels as OpenEXR 3.1 writes them, where exr_file.py does not; zlib's, in base 85.
EXR = {
    "rle": "c-n<hJx?1!5FM|5a0vqOE7Afk0wGfPNRbjmLl^nDTjQ0Ez18gsOvSoEt|CgxE3b4x;qrchOO(nb6>?{k7>?QV22L0$H+nmBqj~dYM|--mRv`eO&IJXjV#beQ"
        "5&xy{@sM%KPP}94M<*htQnH9cIj&$~CGeDY$aoN)!BNz%GgyY#Zvo*T0wzW1o&UGaNbbb}jZ2YH0m0fd+>wI%>cCShf@T<b3Tg#gZ%IF<luz4#r(7ZJwB7`_"
        "BvCFoWPxhEY2mj#&S@yYZ-q=MSjX({RNP$C;>S$pU?u}_X;U}W-&?;*>@3#bkk|P>A@Xgv_n2I}AFp$RUqt7fn#G(2(WY75R5zUL&wiFB$(@trt!k26Kl!P3"
        "!KotLg8$gLK&Fw~G)zqf<Hlgn$kJ2*Nhbn5NuNsbL^Sn_w)-+i71>`Azmwrm80+`iy<razV{hWmIDirUH-=NRFbn@;T4W<V(sx?-(H{DRn~A@5h`sl`ZQyA0"
        "P&N>Mhj4WTq&v>K-R#yJ@5D<T+=bzPu=|+P&zcwgum",
    "piz": "c-n=KA#B?~6oxNTCs~>%83qQLEi0MXvJEV3QGxHhJ881#xXnqfZN*lXGQ+^YK*K=8z(7O8Lc>DC!2M|_HCn;^>!kDP?t9;RcOO0u-UuOz`z#W9u{6nzc#r=)"
        "43gL+k+}_SqA<P9mQkLYG!f_f0WMz5gCdY7nWw+SuXJ^3ge_jacUW(+<|fbL;Qqh&P9=XV=h5<Pcd8;Xvx?#`c@~AmRZy5zT*qlph>NG!<>x$HMp5#N{}v?$"
        "p50wu3+t@J`4wsA#o`}CxCoLYigOVzVv`r*6HdQA7sogFyS~3Vxq5XX#LvM?-5UFemwA=fdP0t+FE{cadufwHH8s@Hk!*H&!o(S`x#B%f6sb(DRi*Z-RgX&O"
        "p&sk0_Ce{q5g3*1WDUxYTp~JvB6tLb&m}KF*>S^<JOgE;YA||b>!TWKSCd}p5-uZ|$r(7kY~kXPPcv%aGU6$_;H-HCmxg=p*oRB49#jL)P+M>zUFu9%=*S19"
        "21igY9k|S>gpCas7bZS$K-$BlV;eRVTpD!*XM~=nZ~;XhyfG$IAr_r7K~_jl4kqIx+o!aMr7TrqE_*O~<>*s<WQ%m3kFH9%SY*=>Ha;zAhuKWf)eJ6M^t6Lb"
        "&qsDKn-*PlaB<L+dzy@1>qh?pAo>0o",
    "pxr24": "c-kw|H)LdDU|=YzEJ$T2E-A{)OK0E(@{5xb^KvrtQZsWC(^Hf4a|?=6i;FY!^B9oXj6j8~DTyVC;hA|U`Q;2r`4vW)3<3-YzztFX#3`A@1v!b81l578^e;+D"
        "Eka^}Y+)$KtVqpqEG|e*E(uC3$;@X+%gIkHVPFC4Zm=&-E=o<!gBb6enpXnUR%VpOz=321vXb!3l#&cIBa$-`^YT)2iW!nKax#lc7|em9P7F*?-HcG|jv*3+"
        "A;Q2A$B3|Z9S~Q{sl9NJ>yQBt+k=wq-9gW8c)GaMOsf(U6r6vnnVsLd;)AD4`0Ob=ji&wMjE%H2n$c`%ZtF7bWcCg9@2Qq;#_Y#-{P<9Dhxcjjlqts5C)TJu"
        "?PgE!>nRjm@R2|Jt@@V0RrB9To{4HzG|l(xDYW=Lv9$DVa_FtsC+F?I`NH7HsTsz}F-7%e7Y;Bj;4=MOuW?(eulU)a8DFB;Z_|iUY~ein_NL^l^s`e9?L`>v"
        "*#R57pWX",
    "b44": "c-kw|H)LdDU|=YzEJ$T2E-A{)OK0E(@{5xb^KvrtQZsWC(^Hf4a|?=6i;FY!^B9oXj6j8KDTyVC;hA|U`Q;2r`4vW)3<3-YzzxK#K%A0UT#%DkNl+cgO8=si"
        ")FLDn$QFiz%!<?;$Krz2<dUGolFWRDw4D6J5(XBq?gsnf<f7EnJc#kmsd*(pZDmGj3>-*SAS(&aOex7gGa@-7F)uGQr<fr*BPX-Cguxsr>IAVI2pFN*9YZ7t"
        "Lxh1LjuBz+A0WQwz}2O(nb!i0WUe!Cw}WUPZ=;*c^#klZI*)xV4g&?)EUq2k^HA8$W6-3rXqU#K>kGI$6kcg8Y67Dh4qO=u5Q%0UgBu&zkj%U(z>Z|*%>uU5"
        "IuHq<nKwRgA(?qIfxScFlc!1(7~Q;pZ00QoWHWCqKsNI>1G1U78j#Jr^#R$;+X={K0sw<MtCj",
}

CONFIG = """ocio_profile_version: 2
search_path: ""
roles: {scene_linear: lin, default: lin}
displays:
  screen:
    - !<View> {name: plain, colorspace: out}
colorspaces:
  - !<ColorSpace> {name: lin, isdata: false}
  - !<ColorSpace>
    name: out
    from_scene_reference: !<ExponentWithLinearTransform> {gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, 0.055, 0], direction: inverse}
"""


def small_room():
    """As calls.c reads it: a method, then a material that reflects and one that shines, and two squares that face each other."""
    grey, lamp, black = [0, 128, 128, 128], [2, 0, 255, 0, 255, 0, 255], [0, 0, 0, 0]

    def square(material, y, order):
        places = [x & 255 for corner in ((-16, y, -16), (-16, y, 16), (16, y, 16), (16, y, -16)) for x in corner]
        return [0, 1, 1, material] + places + list(order)
    return bytes([1, 1] + grey + lamp + black + black + square(0, 0, (0, 1, 2, 0, 2, 3)) + square(1, 16, (0, 2, 1, 0, 3, 2)))


def textured():
    scene = gltf_file.room()
    scene.json["images"] = [{"mimeType": "image/png", "bufferView": len(scene.json["bufferViews"])}]
    picture = gltf_file.png(4, 4, lambda x, y: (40 * x, 40 * y, 200))
    scene.json["bufferViews"].append({"buffer": 0, "byteOffset": len(scene.bin), "byteLength": len(picture)})
    scene.bin += picture
    scene.json["textures"] = [{"source": 0}]
    scene.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    scene.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
    scene.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}, "intensity": 3}]}}
    scene.json["extensionsUsed"] = ["KHR_lights_punctual"]
    scene.json["nodes"].append({"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 2, 0, 1]})
    scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)
    return scene


def draco_chunks(glb):
    """Of a GLB with Draco: the bytes of each of its meshes."""
    length = struct.unpack_from("<I", glb, 12)[0]
    tree, binary = json.loads(glb[20:20 + length]), glb[28 + length:]
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            extension = primitive.get("extensions", {}).get("KHR_draco_mesh_compression")
            if extension:
                view = tree["bufferViews"][extension["bufferView"]]
                begin = view.get("byteOffset", 0)
                yield binary[begin:begin + view["byteLength"]]


def skies():
    """OpenEXR: stored so and so, in parts and layers, in two windows, and what is refused."""
    def rgb(row, column):
        return row, 2 * column, 9
    for kind in (exr_file.HALF, exr_file.FLOAT, exr_file.UINT):
        for compression, tile in (("none", 0), ("zips", 0), ("zip", 0), ("zip", 4), ("dwaa", 0)):
            yield f"{kind[0]}-{compression}-{tile}", exr_file.of_colors(9, 6, rgb, kind, compression=compression, tile=tile)
    colors = {name: (exr_file.HALF, lambda x, y: x) for name in ("R", "G", "B", "A", "a.R", "a.G", "a.B")}
    thin = {"Y": (exr_file.HALF, lambda x, y: x), "A": (exr_file.FLOAT, lambda x, y: y, 2)}
    window, deep = (-2, 2, 7, 7), exr_file.Part(colors, (0, 0, 3, 3), name="deep", kind="deepscanline", compression="zips")
    yield "windows", exr_file.picture(exr_file.Part(colors, window, (0, 0, 9, 9)))
    yield "thin", exr_file.picture(exr_file.Part(thin, window))
    yield "deep", exr_file.picture(deep)
    yield "parts", exr_file.picture(deep, exr_file.Part(thin, window, name="thin"), exr_file.Part(colors, window, name="tiles", tile=4))
    for name, text in EXR.items():
        yield name, zlib.decompress(base64.b85decode(text))


def seeds():
    yield "gltf-room", gltf_file.room().glb()
    yield "gltf-textured", textured().glb()
    for name in ("pillar-room.glb",):
        with open(os.path.join(command.SAMPLES, name), "rb") as f:
            yield f"gltf-{name}", f.read()
    yield "image-rgb", gltf_file.png(3, 5, lambda x, y: (x, y, 9))
    yield "image-rgba16", gltf_file.png(4, 2, lambda x, y: (x, y, 9, 300), channels=4, bits=16)
    yield "hdr-flat", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + bytes(range(16))
    yield "hdr-runs", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\x00\x08" + b"\x88\x11" * 4
    yield "hdr-pfm", b"PF\n2 1\n-1.0\n" + struct.pack("<6f", *range(6))
    for name, data in skies():
        yield "hdr-exr-" + name, data
    with open(os.path.join(command.SAMPLES, "l-room.vs3"), "rb") as f:
        yield "vs3-l-room", f.read()
    yield "hprb-two", command.probes([((0, 0, 0.9), (0, 1, 0), (1, 1, 1)), ((1, 0, 0), (0, 0, 1), (0.5, 0, 2))])
    yield "ies-spot", IES.encode()
    with open(os.path.join(command.ROOT, "color", "hemibake.ocio"), "rb") as f:
        yield "config-own", f.read()
    yield "config-small", CONFIG.encode()
    yield "meshopt-empty", bytes([0, 1, 1, 128]) + b"\xa0" + bytes(40) + b"\xe1" + bytes(30)
    dice = random.Random(1989)
    for kind, count in (("scene", 3), ("bake", 3), ("factor", 8), ("kept", 1), ("rows", 1), ("ckpt", 4)):
        for i in range(count):
            yield f"{kind}-{i}", bytes(dice.randrange(256) for _ in range(40 << (2 * i if kind in ("scene", "bake") else 0)))
    yield "bake-room", small_room()


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    found = list(seeds())
    truth = os.path.join(os.path.dirname(os.path.abspath(__file__)), "regressions")
    for name in os.listdir(truth) if os.path.isdir(truth) else ():
        with open(os.path.join(truth, name), "rb") as f:
            found.append((name, f.read()))
    for path in sys.argv[2:]:  # baked files, for their Draco
        with open(path, "rb") as f:
            data = f.read()
        found.append((f"gltf-{os.path.basename(path)}", data))
        found += [(f"draco-{i}-{os.path.basename(path)}", chunk) for i, chunk in enumerate(draco_chunks(data))]
    for name, data in found:
        with open(os.path.join(folder, name), "wb") as f:
            f.write(data)


if __name__ == "__main__":
    main()
