"""What a glTF or GLB file holds, by its JSON and buffers."""

import base64
import json
import os
import struct
import urllib.parse

from derive_mesh import Box, IDENTITY, keeps_boxes, multiply, transform

COMPONENTS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
NUMBERS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
LARGEST = {"b": 127, "B": 255, "h": 32767, "H": 65535}


class Document:
    def __init__(self, path):
        self.folder = os.path.dirname(path)
        with open(path, "rb") as file:
            data = file.read()
        self.chunk = None
        if data[:4] == b"glTF":
            at = 12
            while at + 8 <= len(data):
                size, kind = struct.unpack_from("<II", data, at)
                part = data[at + 8:at + 8 + size]
                if kind == 0x4E4F534A:
                    self.json = json.loads(part)
                elif kind == 0x004E4942:
                    self.chunk = part
                at += 8 + size
        else:
            self.json = json.loads(data.decode("utf-8-sig"))
        self.buffers = {}
        self.accessors = {}

    def list(self, name):
        return self.json.get(name, [])

    def buffer(self, index):
        if index not in self.buffers:
            uri = self.json["buffers"][index].get("uri")
            if uri is None:
                data = self.chunk
            elif uri.startswith("data:"):
                data = base64.b64decode(uri.split(",", 1)[1])
            else:
                with open(os.path.join(self.folder, urllib.parse.unquote(uri)), "rb") as file:
                    data = file.read()
            self.buffers[index] = data
        return self.buffers[index]

    def can_read(self, index):
        view = self.json["accessors"][index].get("bufferView")
        return view is None or "EXT_meshopt_compression" not in self.json["bufferViews"][view].get("extensions", {})

    def read(self, view_index, offset, count, component, numbers):
        view = self.json["bufferViews"][view_index]
        size = struct.calcsize(component)
        stride = view.get("byteStride") or size * numbers
        start = view.get("byteOffset", 0) + offset
        data = self.buffer(view["buffer"])
        layout = "<%d%s" % (numbers, component)
        if stride == struct.calcsize(layout):
            return list(struct.iter_unpack(layout, data[start:start + count * stride]))
        return [struct.unpack_from(layout, data, start + i * stride) for i in range(count)]

    def accessor(self, index):
        """Tuples of numbers; normalised integers become what they stand for."""
        if index in self.accessors:
            return self.accessors[index]
        a = self.json["accessors"][index]
        component, numbers = COMPONENTS[a["componentType"]], NUMBERS[a["type"]]
        if "bufferView" in a:
            values = self.read(a["bufferView"], a.get("byteOffset", 0), a["count"], component, numbers)
        else:
            values = [(0,) * numbers] * a["count"]
        if "sparse" in a:
            sparse = a["sparse"]
            where, what = sparse["indices"], sparse["values"]
            places = self.read(where["bufferView"], where.get("byteOffset", 0), sparse["count"],
                               COMPONENTS[where["componentType"]], 1)
            news = self.read(what["bufferView"], what.get("byteOffset", 0), sparse["count"], component, numbers)
            for (place,), new in zip(places, news):
                values[place] = new
        if a.get("normalized"):
            most = LARGEST[component]
            values = [tuple(max(x / most, -1.0) for x in value) for value in values]
        self.accessors[index] = values
        return values


def rotation_matrix(q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0], [0, 0, 0, 1]]


def placed(t, r, s):
    m = rotation_matrix(r)
    return [[m[i][k] * s[k] for k in range(3)] + [t[i]] for i in range(3)] + [[0, 0, 0, 1]]


def local_matrix(node):
    if "matrix" in node:
        m = node["matrix"]
        return [[m[4 * c + r] for c in range(4)] for r in range(4)]
    return placed(node.get("translation", [0, 0, 0]), node.get("rotation", [0, 0, 0, 1]), node.get("scale", [1, 1, 1]))


def triangle_count(document, primitive):
    mode = primitive.get("mode", 4)
    if mode < 4:
        return 0
    which = primitive.get("indices", primitive["attributes"]["POSITION"])
    count = document.json["accessors"][which]["count"]
    return count // 3 if mode == 4 else max(count - 2, 0)


class Walk:
    """The default scene, in the pose at rest."""

    def __init__(self, document):
        self.document = document
        self.worlds = {}
        self.order = []
        j = document.json
        if "scenes" in j:
            roots = j["scenes"][j.get("scene", 0)].get("nodes", [])
        else:
            children = {c for node in document.list("nodes") for c in node.get("children", [])}
            roots = [i for i in range(len(document.list("nodes"))) if i not in children]
        waiting = [(root, IDENTITY) for root in reversed(roots)]
        while waiting:
            index, parent = waiting.pop()
            node = j["nodes"][index]
            self.worlds[index] = multiply(parent, local_matrix(node))
            self.order.append(index)
            waiting += [(child, self.worlds[index]) for child in node.get("children", [])]
        self.box = Box()
        self.exact = True  # else the box may be larger than the scene
        self.placed_triangles = self.emissive = 0

    def instance_matrices(self, index):
        node = self.document.json["nodes"][index]
        attributes = node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes")
        if attributes is None:
            return [self.worlds[index]]
        read = {name: self.document.accessor(a) for name, a in attributes.items()}
        count = max(len(values) for name, values in read.items())
        t = read.get("TRANSLATION", [(0, 0, 0)] * count)
        r = read.get("ROTATION", [(0, 0, 0, 1)] * count)
        s = read.get("SCALE", [(1, 1, 1)] * count)
        return [multiply(self.worlds[index], placed(t[i], r[i], s[i])) for i in range(count)]

    def add_primitive(self, node, primitive, weights, matrices):
        document = self.document
        count = triangle_count(document, primitive)
        self.placed_triangles += count * len(matrices)
        if count == 0:
            return
        material = document.list("materials")[primitive["material"]] if "material" in primitive else {}
        if any(material.get("emissiveFactor", [0, 0, 0])):
            self.emissive += count * len(matrices)
        which = primitive["attributes"]["POSITION"]
        accessor = document.json["accessors"][which]
        # What Draco leaves of the numbers is a little off the box that the file names.
        is_draco = "KHR_draco_mesh_compression" in primitive.get("extensions", {})
        compressed = is_draco or not document.can_read(which)
        moves = "skin" in node or any(weights)
        plain = accessor["componentType"] == 5126 and "min" in accessor and not moves
        if compressed or (plain and all(keeps_boxes(m) for m in matrices)):
            low, high = accessor["min"], accessor["max"]
            if accessor.get("normalized"):
                most = LARGEST[COMPONENTS[accessor["componentType"]]]
                low, high = [x / most for x in low], [x / most for x in high]
            for m in matrices:
                self.exact = self.exact and keeps_boxes(m) and not moves and not is_draco
                self.box.add_corners(low, high, m)
            return
        positions = document.accessor(which)
        for target, weight in zip(primitive.get("targets", []), weights):
            if weight and "POSITION" in target:
                moved = document.accessor(target["POSITION"])
                positions = [tuple(p[k] + weight * d[k] for k in range(3)) for p, d in zip(positions, moved)]
        if "skin" in node:
            self.add_skinned(node, primitive["attributes"], positions)
            return
        for m in matrices:
            for p in positions:
                self.box.add(transform(m, p))

    def add_skinned(self, node, attributes, positions):
        document = self.document
        skin = document.json["skins"][node["skin"]]
        binds = [IDENTITY] * len(skin["joints"])
        if "inverseBindMatrices" in skin:
            binds = [[[m[4 * c + r] for c in range(4)] for r in range(4)]
                     for m in document.accessor(skin["inverseBindMatrices"])]
        joints = [multiply(self.worlds[joint], bind) for joint, bind in zip(skin["joints"], binds)]
        indices, weights = document.accessor(attributes["JOINTS_0"]), document.accessor(attributes["WEIGHTS_0"])
        for p, index, weight in zip(positions, indices, weights):
            total = sum(weight) or 1.0
            sum_of = [0.0] * 3
            for joint, part in zip(index, weight):
                if part:
                    q = transform(joints[joint], p)
                    for k in range(3):
                        sum_of[k] += part / total * q[k]
            self.box.add(sum_of)


def derive_gltf(path):
    document = Document(path)
    walk = Walk(document)
    nodes, meshes = document.list("nodes"), document.list("meshes")
    lights = cameras = without_material = 0
    for index in walk.order:
        node = nodes[index]
        cameras += "camera" in node
        lights += "light" in node.get("extensions", {}).get("KHR_lights_punctual", {})
        if "mesh" not in node:
            continue
        mesh = meshes[node["mesh"]]
        matrices = walk.instance_matrices(index)
        for primitive in mesh["primitives"]:
            without_material += "material" not in primitive
            weights = node.get("weights", mesh.get("weights", []))
            walk.add_primitive(node, primitive, weights, matrices)
    animations = []
    for animation in document.list("animations"):
        ends = [document.json["accessors"][s["input"]].get("max", [0])[0] for s in animation["samplers"]]
        animations.append(max(ends, default=0))
    variants = document.json.get("extensions", {}).get("KHR_materials_variants", {}).get("variants", [])
    return {"placed_triangles": walk.placed_triangles, "materials": len(document.list("materials")),
            "without_material": without_material, "lights": lights, "emissive_triangles": walk.emissive,
            "cameras": cameras, "animations": animations, "skins": len(document.list("skins")),
            "variants": [v["name"] for v in variants], "bounds": walk.box.as_json(),
            "bounds_of": "all vertices" if walk.exact else "boxes"}
