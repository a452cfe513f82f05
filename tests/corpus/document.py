# SPDX-License-Identifier: MIT
"""What does a glTF document say once its numbers for other objects are replaced by what those objects hold?

Two documents whose accessors, textures and images are numbered differently become comparable that way. Numbers that are
not integers keep their text, so that 0.10 and 0.1 differ.
"""

import base64
import copy
import hashlib
import json
import os
import struct
import urllib.parse


class Literal(str):
    """A number as it was written."""


class Document:
    def __init__(self, path, literal=True):
        with open(path, "rb") as f:
            data = f.read()
        self.folder, self.bin, text = os.path.dirname(path), b"", data
        self.is_glb = data[:4] == b"glTF"
        if self.is_glb:
            length, = struct.unpack("<I", data[12:16])
            text, self.bin = data[20:20 + length], data[28 + length:]
        self.json = json.loads(text.decode("utf-8-sig").rstrip("\0 \n"), parse_float=Literal if literal else float)
        self.buffers = {}

    def list(self, name):
        return self.json.get(name, [])

    # ---- bytes -----------------------------------------------------------------------------------------------------

    def resource(self, uri):
        """Bytes behind a uri; None if there is no such file."""
        if uri.startswith("data:"):
            head, _, body = uri.partition(",")
            return base64.b64decode(body) if head.endswith(";base64") else urllib.parse.unquote_to_bytes(body)
        path = os.path.join(self.folder, urllib.parse.unquote(uri))
        if not os.path.isfile(path):
            return None
        with open(path, "rb") as f:
            return f.read()

    def buffer(self, index):
        if index not in self.buffers:
            uri = self.list("buffers")[index].get("uri")
            self.buffers[index] = self.resource(uri) if uri else self.bin
        return self.buffers[index]

    def view(self, index):
        """Digest of the bytes of a buffer view; None if they are packed."""
        view = self.list("bufferViews")[index]
        if "EXT_meshopt_compression" in view.get("extensions", {}):
            return None
        start = view.get("byteOffset", 0)
        return hashlib.sha256(self.buffer(view["buffer"])[start:start + view["byteLength"]]).hexdigest()

    # ---- objects with their numbers resolved --------------------------------------------------------------------------

    def accessor(self, index):
        accessor = copy.deepcopy(self.list("accessors")[index])
        holders = [accessor] + [accessor["sparse"][k] for k in ("indices", "values") if "sparse" in accessor]
        for holder in holders:
            if "bufferView" in holder:
                view = self.list("bufferViews")[holder["bufferView"]]
                holder["bufferView"] = [self.view(holder["bufferView"]), view.get("byteStride"), view.get("name")]
        return accessor

    def image(self, index):
        image = copy.deepcopy(self.list("images")[index])
        data = self.view(image["bufferView"]) if "bufferView" in image else None
        if "uri" in image and self.resource(image["uri"]) is not None:
            data = hashlib.sha256(self.resource(image.pop("uri"))).hexdigest()
        if data:
            image.pop("mimeType", None)
            image["bufferView"] = data
        return image

    def texture(self, index):
        texture = copy.deepcopy(self.list("textures")[index])
        if "sampler" in texture:
            texture["sampler"] = self.list("samplers")[texture["sampler"]]
        for holder in [texture, *(e for e in texture.get("extensions", {}).values() if isinstance(e, dict))]:
            if "source" in holder:
                holder["source"] = self.image(holder["source"])
        return texture

    def with_textures(self, value):
        if isinstance(value, list):
            return [self.with_textures(v) for v in value]
        if not isinstance(value, dict):
            return value
        out = {}
        for key, member in value.items():
            out[key] = self.with_textures(member) if key != "extras" else member
            if key.endswith("Texture") and isinstance(member, dict) and isinstance(member.get("index"), int):
                out[key] = {**out[key], "index": self.texture(member["index"])}
        return out

    def material(self, index):
        return self.with_textures(self.list("materials")[index]) if index is not None else {}

    def primitive(self, source):
        primitive = copy.deepcopy(source)
        for key in ("attributes", "indices"):
            if key in primitive:
                value = primitive[key]
                primitive[key] = self.accessor(value) if key == "indices" else {k: self.accessor(a) for k, a in value.items()}
        if "targets" in primitive:
            primitive["targets"] = [{k: self.accessor(a) for k, a in target.items()} for target in primitive["targets"]]
        if "material" in primitive:
            primitive["material"] = self.material(primitive["material"])
        draco = primitive.get("extensions", {}).get("KHR_draco_mesh_compression")
        if draco:
            draco["bufferView"] = self.view(draco["bufferView"])
        return primitive

    def skins(self):
        skins = copy.deepcopy(self.list("skins"))
        for skin in skins:
            if "inverseBindMatrices" in skin:
                skin["inverseBindMatrices"] = self.accessor(skin["inverseBindMatrices"])
        return skins

    def animations(self):
        animations = copy.deepcopy(self.list("animations"))
        for animation in animations:
            for sampler in animation["samplers"]:
                sampler["input"], sampler["output"] = self.accessor(sampler["input"]), self.accessor(sampler["output"])
        return animations
