#!/usr/bin/env python3
"""Derives what scene files hold, without any of snell's readers: the numbers that `snell info` is held against.

    derive.py FOLDER [--most-bytes N]      prints one JSON object, by the files' paths in the folder
"""

import argparse
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from derive_gltf import derive_gltf
from derive_mesh import derive_obj, derive_ply, derive_stl
from derive_pbrt import derive_pbrt

READERS = {".gltf": derive_gltf, ".glb": derive_gltf, ".pbrt": derive_pbrt, ".obj": derive_obj, ".ply": derive_ply,
           ".stl": derive_stl}


def is_scene(folder, name):
    """Not the parts of other scenes: meshes beside a .pbrt file, and what pbrt files include."""
    ending = os.path.splitext(name)[1].lower()
    if ending not in READERS:
        return False
    if ending == ".ply" and "pbrt" in os.path.relpath(folder):
        return False
    if ending == ".pbrt":
        with open(os.path.join(folder, name), encoding="latin-1") as file:
            return "WorldBegin" in file.read()
    return True


def find_scenes(root):
    for folder, folders, names in os.walk(root):
        folders.sort()
        for name in sorted(names):
            if is_scene(folder, name):
                yield os.path.join(folder, name)


def bytes_beside(path):
    """What a scene may have to read: its own bytes, and for formats that refer to others their folder's."""
    if os.path.splitext(path)[1].lower() not in (".gltf", ".pbrt"):
        return os.path.getsize(path)
    return sum(os.path.getsize(os.path.join(folder, name))
               for folder, _, names in os.walk(os.path.dirname(path)) for name in names)


def derive(path):
    return READERS[os.path.splitext(path)[1].lower()](path)


def derive_all(root, most_bytes):
    result, left_out = {}, []
    for path in find_scenes(root):
        if bytes_beside(path) > most_bytes:
            left_out.append(os.path.relpath(path, root))
        else:
            result[os.path.relpath(path, root)] = derive(path)
    return result, left_out


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--most-bytes", type=float, default=float("inf"))
    arguments = parser.parse_args()
    print(json.dumps(derive_all(arguments.folder, arguments.most_bytes)[0], indent=1))
