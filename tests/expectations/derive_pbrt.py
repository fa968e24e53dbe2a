"""What a pbrt file holds, by its directives."""

import gzip
import math
import os
import re

from derive_mesh import Box, IDENTITY, Ply, keeps_boxes, multiply, transform

TOKEN = re.compile(r'#[^\n]*|"[^"]*"|[\[\]]|[^\s\[\]"#]+')


def tokens_of(path):
    with open(path, "rb") as file:
        data = file.read()
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    return [t for t in TOKEN.findall(data.decode("latin-1")) if t[0] != "#"]


def rotation(degrees, x, y, z):
    size = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / size, y / size, z / size
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    t = 1 - c
    return [[t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0], [0, 0, 0, 1]]


def look_at(e, t, up):
    """World to camera."""
    def unit(v):
        size = math.sqrt(sum(a * a for a in v))
        return [a / size for a in v]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    d = unit([t[k] - e[k] for k in range(3)])
    right = unit(cross(unit(up), d))
    new_up = cross(d, right)
    rows = [right, new_up, d]
    return [row + [-sum(row[k] * e[k] for k in range(3))] for row in rows] + [[0, 0, 0, 1]]


def columns(numbers):
    return [[numbers[4 * c + r] for c in range(4)] for r in range(4)]


# How many numbers follow a directive.
NUMBERS = {"Translate": 3, "Scale": 3, "Rotate": 4, "LookAt": 9, "TransformTimes": 2}


class State:
    def __init__(self, other=None):
        self.matrix = other.matrix if other else IDENTITY
        self.material = other.material if other else "diffuse"
        self.shines = other.shines if other else False


class Reader:
    def __init__(self, path):
        self.folder = os.path.dirname(path)
        self.state, self.stack, self.named, self.materials = State(), [], {}, {}
        self.box, self.exact = Box(), True
        self.result = {"placed_triangles": 0, "placed_spheres": 0, "tessellated": 0, "lights": 0, "infinite": 0,
                       "emissive_triangles": 0, "cameras": 0}
        self.objects, self.object = {}, None
        self.read(path)

    # ---- tokens ----

    def parameters(self, tokens, at):
        found = {}
        while at < len(tokens) and tokens[at][0] == '"':
            name = tokens[at][1:-1].split()[-1]
            at += 1
            values = []
            if tokens[at] == "[":
                at += 1
                while tokens[at] != "]":
                    values.append(tokens[at])
                    at += 1
            else:
                values.append(tokens[at])
            at += 1
            found[name] = values
        return found, at

    def numbers(self, tokens, at, count):
        found = []
        while len(found) < count:
            if tokens[at] not in "[]":
                found.append(float(tokens[at]))
            at += 1
        while at < len(tokens) and tokens[at] == "]":
            at += 1
        return found, at

    def read(self, path):
        tokens = tokens_of(path)
        at = 0
        while at < len(tokens):
            word = tokens[at]
            at += 1
            if word in NUMBERS:
                values, at = self.numbers(tokens, at, NUMBERS[word])
                self.move(word, values)
            elif word in ("Transform", "ConcatTransform"):
                values, at = self.numbers(tokens, at, 16)
                m = columns(values)
                self.state.matrix = m if word == "Transform" else multiply(self.state.matrix, m)
            elif word in ("AttributeBegin", "TransformBegin", "ObjectBegin"):
                self.stack.append((self.state, self.object))
                self.state = State(self.state)
                if word == "ObjectBegin":
                    self.object = self.objects.setdefault(tokens[at], [])
                    at += 1
            elif word in ("AttributeEnd", "TransformEnd", "ObjectEnd"):
                left = self.state
                self.state, self.object = self.stack.pop()
                if word == "TransformEnd":
                    self.state.material, self.state.shines = left.material, left.shines
            elif word == "Identity":
                self.state.matrix = IDENTITY
            elif word == "WorldBegin":
                self.state.matrix = IDENTITY
            elif word in ("ReverseOrientation", "WorldEnd"):
                pass
            elif word in ("Include", "Import"):
                self.read(os.path.join(self.folder, tokens[at][1:-1]))
                at += 1
            elif word == "ObjectInstance":
                for shape in self.objects.get(tokens[at], []):
                    self.place(*shape[:2], multiply(self.state.matrix, shape[2]), shape[3], False)
                at += 1
            elif word in ("CoordinateSystem", "CoordSysTransform", "NamedMaterial", "ActiveTransform"):
                if word == "NamedMaterial":
                    self.state.material = self.materials.get(tokens[at], "?")
                if word == "CoordinateSystem":
                    self.named[tokens[at]] = self.state.matrix
                if word == "CoordSysTransform":
                    self.state.matrix = self.named.get(tokens[at], self.state.matrix)
                at += 1
            elif word == "MediumInterface":
                while at < len(tokens) and tokens[at][0] == '"':
                    at += 1
            elif word == "Texture":
                _, at = self.parameters(tokens, at + 3)
            else:
                kind = tokens[at]
                parameters, at = self.parameters(tokens, at + 1)
                self.use(word, kind, parameters)

    # ---- directives ----

    def move(self, word, v):
        if word == "Translate":
            m = [[1, 0, 0, v[0]], [0, 1, 0, v[1]], [0, 0, 1, v[2]], [0, 0, 0, 1]]
        elif word == "Scale":
            m = [[v[0], 0, 0, 0], [0, v[1], 0, 0], [0, 0, v[2], 0], [0, 0, 0, 1]]
        elif word == "Rotate":
            m = rotation(*v)
        elif word == "LookAt":
            m = look_at(v[0:3], v[3:6], v[6:9])
        else:
            return
        self.state.matrix = multiply(self.state.matrix, m)

    def use(self, word, kind, parameters):
        if word == "Material":
            self.state.material = kind[1:-1]
        elif word == "MakeNamedMaterial":
            self.materials[kind] = parameters.get("type", ['"matte"'])[0][1:-1]
        elif word == "AreaLightSource":
            self.state.shines = True
        elif word == "LightSource":
            self.result["infinite" if kind == '"infinite"' else "lights"] += 1
        elif word == "Camera":
            self.named['"camera"'] = IDENTITY
            self.result["cameras"] += 1
        elif word == "Shape":
            # What only bounds a medium is not to be seen.
            if self.state.material in ("interface", "none", "") and not self.state.shines:
                return
            if self.object is not None:
                self.object.append((kind[1:-1], parameters, self.state.matrix, self.folder))
            else:
                self.place(kind[1:-1], parameters, self.state.matrix, self.folder, self.state.shines)

    def place(self, kind, parameters, matrix, folder, shines):
        triangles = 0
        if kind == "sphere":
            radius = float(parameters.get("radius", [1])[0])
            self.result["placed_spheres"] += 1
            for k in range(3):
                reach = radius * math.sqrt(sum(matrix[k][c] ** 2 for c in range(3)))
                for sign in (-1, 1):
                    p = [matrix[r][3] for r in range(3)]
                    p[k] += sign * reach
                    self.box.add(p)
        elif kind in ("trianglemesh", "loopsubdiv"):
            p = [float(x) for x in parameters["P"]]
            points = list(zip(p[0::3], p[1::3], p[2::3]))
            indices = [int(i) for i in parameters["indices"]] if "indices" in parameters else range(3)
            triangles = len(indices) // 3
            if kind == "loopsubdiv":
                triangles *= 4 ** int(parameters.get("levels", parameters.get("nlevels", [3]))[0])
                self.exact = False  # the limit lies inside the control mesh's hull
            self.add_points([points[i] for i in set(indices)], matrix)
        elif kind == "plymesh":
            ply = Ply(os.path.join(folder, parameters["filename"][0][1:-1]))
            triangles = ply.triangles
            self.add_points(ply.positions, matrix)
        else:
            self.result["tessellated"] += 1
            self.exact = None  # its bounds are not derived
        self.result["placed_triangles"] += triangles
        if shines:
            self.result["emissive_triangles"] += triangles

    def add_points(self, points, matrix):
        if not points:
            return
        if keeps_boxes(matrix):
            axes = list(zip(*points))
            self.box.add_corners([min(a) for a in axes], [max(a) for a in axes], matrix)
            return
        for p in points:
            self.box.add(transform(matrix, p))


def derive_pbrt(path):
    reader = Reader(path)
    result = reader.result
    if reader.exact is not None:
        result["bounds"] = reader.box.as_json()
        result["bounds_of"] = "all vertices" if reader.exact else "boxes"
    return result
