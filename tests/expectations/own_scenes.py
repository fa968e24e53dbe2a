"""Small scenes with numbers counted by hand."""

import json
import os
import struct


def f32(values):
    return struct.pack("<%df" % len(values), *values)


def pad(data, to=4, with_byte=b"\0"):
    return data + with_byte * (-len(data) % to)


# A quad in z = 0 from -1 to 1, once shaded and once glowing; a rotated and a mirrored copy; an animation of 1.5 s.
def glb():
    positions = f32([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0])
    indices = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    times, moves = f32([0, 1.5]), f32([0, 0, 0, 0, 5, 0])
    # A sparse accessor moves vertex 2 to (3, 3, 0).
    where, what = pad(struct.pack("<H", 2)), f32([3, 3, 0])
    parts = [positions, pad(indices), times, moves, where, what]
    views, at = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part)
    box = {"min": [-1, -1, 0], "max": [1, 1, 0]}
    half = 0.7071067811865476
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 3, 4, 5]}, {"nodes": [2]}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}, {"type": "directional"}]}},
        "nodes": [
            {"mesh": 0, "translation": [10, 0, 0], "scale": [2, 1, 1], "children": [1]},
            {"mesh": 0, "rotation": [0, 0, half, half], "translation": [0, 20, 0]},
            {"mesh": 1, "translation": [1000, 0, 0]},  # in no scene that is shown
            {"mesh": 1, "scale": [-1, 1, 1]},
            {"camera": 0, "translation": [0, 0, 9]},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]},
            {"primitives": [{"attributes": {"POSITION": 4}, "indices": 1, "material": 1},
                            {"attributes": {"POSITION": 0}, "mode": 5}]},
        ],
        "materials": [{}, {"emissiveFactor": [1, 1, 1]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                        "samplers": [{"input": 2, "output": 3}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, **box},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6},
            {"bufferView": 2, "componentType": 5126, "type": "SCALAR", "count": 2, "min": [0], "max": [1.5]},
            {"bufferView": 3, "componentType": 5126, "type": "VEC3", "count": 2},
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, "min": [-1, -1, 0], "max": [3, 3, 0],
             "sparse": {"count": 1, "indices": {"bufferView": 4, "componentType": 5123}, "values": {"bufferView": 5}}},
        ],
        "bufferViews": views, "buffers": [{"byteLength": at}],
    }
    text = pad(json.dumps(document).encode(), with_byte=b" ")
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", at, 0x004E4942) + b"".join(parts)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


GLB = {"placed_triangles": 2 + 2 + 2 + 2, "materials": 2, "without_material": 1, "lights": 1, "emissive_triangles": 2,
       "cameras": 1, "animations": [1.5], "variants": []}

OBJ = b"""mtllib none.mtl
v 0 0 0\r
v 2 0 0
v 2 1 0
v 0 1 0
v 1 2 -3
v 99 99 99
vt 0 0
vn 0 0 1
vn 0 0 1
usemtl a
f 1 2 3 4
usemtl b
f -6/1/1 -5//2 \\
  -2
"""

PBRT = b"""LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 30
WorldBegin # here it begins
LightSource "point" "rgb I" [ 1 1 1 ]
LightSource "infinite" "rgb L" [ .1 .1 .1 ]
AttributeBegin
  Translate 0 0 2  Scale 2 1 1
  Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 -1 0 1 -1 0 1 1 0 -1 1 0]
  Translate 1 0 0
  Shape "sphere" "float radius" .5
AttributeEnd
ObjectBegin "thing"
  Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0]
ObjectEnd
AttributeBegin
  Rotate 90 0 0 1
  ObjectInstance "thing"
  Scale 4 4 4
  ObjectInstance "thing"
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [1 1 1]
  Translate 0 3 0
  Shape "trianglemesh" "integer indices" [0 1 2] "point3 P" [0 0 0 1 0 0 0 0 1]
AttributeEnd
"""


def ply():
    header = (b"ply\nformat binary_big_endian 1.0\ncomment odd order\nelement face 2\nproperty list uchar int vertex_indices\n"
              b"property uchar red\nelement vertex 5\nproperty uchar tag\nproperty float x\nproperty float y\n"
              b"property double z\nend_header\n")
    faces = struct.pack(">B4iB", 4, 0, 1, 2, 3, 7) + struct.pack(">B3iB", 3, 0, 1, 4, 7)
    points = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 1, -4)]
    return header + faces + b"".join(struct.pack(">Bffd", 1, *p) for p in points)


def stl():
    facets = [(0, 0, 0, 1, 0, 0, 0, 1, 0), (0, 0, 0, 0, 1, 0, 0, 0, 3)]
    return b"solid by its first word".ljust(80) + struct.pack("<I", 2) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *facet, 0) for facet in facets)


def box(*numbers):
    return {"lower": [float(x) for x in numbers[:3]], "upper": [float(x) for x in numbers[3:]]}


def write(folder):
    """Writes them; what is in each, by file."""
    files = {
        "scene.glb": (glb(), GLB),
        "mesh.obj": (OBJ, {"triangles": 3, "used_materials": 2, "bounds": box(0, 0, -3, 2, 2, 0)}),
        "mesh.ply": (ply(), {"triangles": 3, "bounds": box(0, 0, -4, 2, 2, 0)}),
        "mesh.stl": (stl(), {"triangles": 2, "bounds": box(0, 0, 0, 1, 1, 3)}),
        "scene.pbrt": (PBRT, {"placed_triangles": 2 + 1 + 1 + 1, "placed_spheres": 1, "lights": 1, "infinite": 1,
                              "emissive_triangles": 1, "cameras": 1}),
    }
    for name, (data, _) in files.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(data)
    return {name: numbers for name, (_, numbers) in files.items()}
