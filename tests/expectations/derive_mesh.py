"""What OBJ, PLY and STL files hold, by their own headers and lines."""

import gzip
import os
import struct
import sys


def read_bytes(path):
    with open(path, "rb") as file:
        data = file.read()
    return gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data


class Box:
    """The least and greatest coordinates of points."""

    def __init__(self):
        self.lower = [float("inf")] * 3
        self.upper = [float("-inf")] * 3

    def add(self, p):
        for k in range(3):
            if p[k] < self.lower[k]:
                self.lower[k] = p[k]
            if p[k] > self.upper[k]:
                self.upper[k] = p[k]

    def add_corners(self, lower, upper, matrix):
        """The corners of a box under a map; exact if the map only stretches and exchanges axes."""
        for i in range(8):
            self.add(transform(matrix, [upper[k] if i >> k & 1 else lower[k] for k in range(3)]))

    def as_json(self):
        return None if self.lower[0] > self.upper[0] else {"lower": self.lower, "upper": self.upper}


def transform(m, p):
    return [m[r][0] * p[0] + m[r][1] * p[1] + m[r][2] * p[2] + m[r][3] for r in range(3)]


IDENTITY = [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1.0]]


def multiply(a, b):
    return [[sum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)] for r in range(4)]


def keeps_boxes(m):
    """Whether boxes stay boxes with edges along the axes."""
    return all(sum(abs(m[r][c]) > 1e-12 for c in range(3)) <= 1 for r in range(3))


# ---- PLY ----

PLY_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H",
             "uint16": "H", "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f",
             "double": "d", "float64": "d"}


class Ply:
    """Triangles (polygons as fans) and positions of the vertices."""

    def __init__(self, path):
        data = read_bytes(path)
        end = data.index(b"end_header")
        begin = data.index(b"\n", end) + 1 if b"\n" in data[end:end + 12] else end + 11
        self.format, elements = None, []
        for line in data[:end].decode("latin-1").splitlines():
            words = line.split()
            if not words:
                continue
            if words[0] == "format":
                self.format = words[1]
            elif words[0] == "element":
                elements.append((words[1], int(words[2]), []))
            elif words[0] == "property":
                elements[-1][2].append(words[1:])
        self.positions, self.triangles = [], 0
        body = data[begin:]
        if self.format == "ascii":
            self.read_ascii(elements, body)
        else:
            self.read_binary(elements, body, "<" if "little" in self.format else ">")

    def count_face(self, corners):
        self.triangles += max(corners - 2, 0)

    def read_ascii(self, elements, body):
        words = body.split()
        at = 0
        for name, count, properties in elements:
            is_flat = all(p[0] != "list" for p in properties)
            names = [p[-1] for p in properties]
            if is_flat:
                width = len(properties)
                if name == "vertex":
                    axes = [list(map(float, words[at + names.index(a):at + width * count:width])) for a in "xyz"]
                    self.positions = list(zip(*axes))
                at += width * count
                continue
            for _ in range(count):
                for p in properties:
                    if p[0] == "list":
                        size = int(words[at])
                        if name == "face" and p[-1].startswith("vertex_ind"):
                            self.count_face(size)
                        at += 1 + size
                    else:
                        at += 1

    def read_binary(self, elements, body, order):
        at = 0
        for name, count, properties in elements:
            if all(p[0] != "list" for p in properties):
                layout = order + "".join(PLY_TYPES[p[0]] for p in properties)
                size = struct.calcsize(layout)
                if name == "vertex":
                    x, y, z = ([p[-1] for p in properties].index(a) for a in "xyz")
                    self.positions = [(v[x], v[y], v[z]) for v in struct.iter_unpack(layout, body[at:at + size * count])]
                at += size * count
                continue
            if len(properties) == 1 and PLY_TYPES[properties[0][1]] in "bB":
                stride = 1 + 3 * struct.calcsize(order + PLY_TYPES[properties[0][2]])
                if body[at:at + count * stride:stride] == b"\x03" * count:  # the usual case, and quick
                    self.triangles += count if name == "face" else 0
                    at += count * stride
                    continue
            for _ in range(count):
                for p in properties:
                    if p[0] != "list":
                        at += struct.calcsize(order + PLY_TYPES[p[0]])
                        continue
                    (length,) = struct.unpack_from(order + PLY_TYPES[p[1]], body, at)
                    at += struct.calcsize(order + PLY_TYPES[p[1]]) + length * struct.calcsize(order + PLY_TYPES[p[2]])
                    if name == "face" and p[-1].startswith("vertex_ind"):
                        self.count_face(length)


def derive_ply(path):
    ply = Ply(path)
    box = Box()
    if ply.positions:
        for k, axis in enumerate(zip(*ply.positions)):
            box.lower[k], box.upper[k] = min(axis), max(axis)
    return {"triangles": ply.triangles, "bounds": box.as_json(), "bounds_of": "all vertices"}


# ---- STL ----

def derive_stl(path):
    data = read_bytes(path)
    box = Box()
    if len(data) >= 84 and b"vertex" not in data[:2000]:
        (count,) = struct.unpack_from("<I", data, 80)
        for record in struct.iter_unpack("<12fH", data[84:84 + 50 * count]):
            for corner in range(3):
                box.add(record[3 + 3 * corner:6 + 3 * corner])
    else:
        words = data.split()
        corners = [i for i, word in enumerate(words) if word == b"vertex"]
        count = len(corners) // 3
        for i in corners:
            box.add([float(words[i + k]) for k in (1, 2, 3)])
    return {"triangles": count, "bounds": box.as_json()}


# ---- OBJ ----

def derive_obj(path):
    data = read_bytes(path)
    text = data.decode("utf-16") if data[:2] in (b"\xff\xfe", b"\xfe\xff") else data.decode("latin-1")
    text = text.replace("\\\r\n", " ").replace("\\\n", " ")
    vertices, used, triangles = [], set(), 0
    materials, material = set(), ""
    for line in text.splitlines():
        if line.startswith("v "):
            vertices.append(tuple(map(float, line.split()[1:4])))
        elif line.startswith("f ") or line.startswith("f\t"):
            corners = line.split("#")[0].split()[1:]
            if len(corners) < 3:
                continue
            triangles += len(corners) - 2
            materials.add(material)
            for corner in corners:
                index = int(corner.split("/", 1)[0])
                used.add(index - 1 if index > 0 else len(vertices) + index)
        elif line.startswith("usemtl"):
            material = line[6:].strip()
    box = Box()
    for index in used:
        box.add(vertices[index])
    return {"triangles": triangles, "bounds": box.as_json(), "used_materials": len(materials)}


if __name__ == "__main__":
    for name in sys.argv[1:]:
        ending = os.path.splitext(name)[1].lower()
        print(name, {".ply": derive_ply, ".stl": derive_stl, ".obj": derive_obj}[ending](name))
