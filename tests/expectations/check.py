#!/usr/bin/env python3
"""Holds `snell info --json` against what derive.py finds in the same files.

    check.py SNELL own                          small scenes made here, whose numbers are written beside them
    check.py SNELL FOLDER [--most-bytes N]      all scenes in a folder

One line for each difference; exit code 1 if there is any.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import derive
import own_scenes


def info(snell, path):
    done = subprocess.run([snell, "info", path, "--json"], capture_output=True, text=True, errors="replace")
    if done.returncode != 0:
        return None, done.stderr.strip()
    return json.loads(done.stdout), ""


def dropped(ours):
    """Triangles that were left out because they are no surface; the report says so."""
    return sum(f["count"] for f in ours["findings"] if f["kind"] in ("degenerate-triangles", "non-finite-vertices"))


def compare_bounds(expected, ours, said):
    box, mine = expected["bounds"], ours["bounds"]
    if box is None or mine is None:
        if box is not mine:
            said("bounds", box, mine)
        return
    size = max(box["upper"][k] - box["lower"][k] for k in range(3))
    far = max(abs(x) for x in box["upper"] + box["lower"])
    tolerance = 1e-5 * size + 1e-6 * far
    is_outer = expected.get("bounds_of") == "boxes"
    for k in range(3):
        below, above = mine["lower"][k] - box["lower"][k], box["upper"][k] - mine["upper"][k]
        # Where only a box around the whole is known, ours may be smaller, but not by half.
        most = 0.5 * size if is_outer else tolerance
        if not (-tolerance <= below <= most and -tolerance <= above <= most):
            said("bounds along " + "xyz"[k], [box["lower"][k], box["upper"][k]], [mine["lower"][k], mine["upper"][k]])


def compare(expected, ours):
    differences = []

    def said(what, theirs, mine):
        differences.append(f"{what}: expected {theirs}, got {mine}")

    lost = dropped(ours)
    triangles = expected.get("placed_triangles", expected.get("triangles"))
    if expected.get("tessellated", 0) == 0 and not triangles - lost <= ours["placed_triangles"] <= triangles:
        said(f"triangles ({lost} dropped)", triangles, ours["placed_triangles"])
    if expected.get("tessellated", 0) > 0 and not ours["placed_triangles"] > triangles - lost:
        said("triangles besides tessellated shapes", f"more than {triangles}", ours["placed_triangles"])

    # A material more where something has none.
    if "materials" in expected:
        least = expected["materials"]
        most = least + (1 if expected["without_material"] else 0)
        if not least <= ours["materials"] <= most:
            said("materials", least, ours["materials"])
    if "used_materials" in expected and not ours["materials"] >= expected["used_materials"]:
        said("materials", f"at least {expected['used_materials']}", ours["materials"])
    if "placed_spheres" in expected and ours["placed_spheres"] != expected["placed_spheres"]:
        said("spheres", expected["placed_spheres"], ours["placed_spheres"])

    kinds = ours["lights_by_kind"]
    if "lights" in expected:
        mine = sum(kinds.get(kind, 0) for kind in ("point", "directional", "spot"))
        if mine != expected["lights"]:
            said("lights", expected["lights"], mine)
    if "emissive_triangles" in expected:
        theirs, mine = expected["emissive_triangles"], kinds.get("triangle", 0)
        if not max(theirs - lost, 0) <= mine or (mine > theirs and expected.get("tessellated", 0) == 0):
            said("emissive triangles", theirs, mine)
    if "infinite" in expected:
        mine = any(ours["environment"])
        if mine != (expected["infinite"] > 0):
            said("environment", expected["infinite"], ours["environment"])
    if "cameras" in expected and len(ours["cameras"]) != expected["cameras"]:
        said("cameras", expected["cameras"], len(ours["cameras"]))

    mine = [a["seconds"] for a in ours["animations"]]
    theirs = expected.get("animations", [])
    if len(mine) != len(theirs) or any(abs(a - b) > 1e-4 for a, b in zip(mine, theirs)):
        said("seconds of animations", theirs, mine)
    if "skins" in expected and ours["skins"] != expected["skins"]:
        said("skins", expected["skins"], ours["skins"])
    if ours["variants"] != expected.get("variants", []):
        said("variants", expected["variants"], ours["variants"])
    if "bounds" in expected:
        compare_bounds(expected, ours, said)
    return differences


def check(snell, root, expectations):
    wrong = 0
    for name, expected in sorted(expectations.items()):
        ours, error = info(snell, os.path.join(root, name))
        differences = [error] if ours is None else compare(expected, ours)
        for difference in differences:
            print(f"{name}: {difference}")
        wrong += len(differences) > 0
    print(f"{len(expectations)} scenes, {wrong} of them differ")
    return wrong


def check_own(snell):
    """First the deriving against numbers written by hand, then the program against both."""
    with tempfile.TemporaryDirectory() as folder:
        by_hand = own_scenes.write(folder)
        derived, _ = derive.derive_all(folder, float("inf"))
        wrong = 0
        for name, numbers in by_hand.items():
            for key, value in numbers.items():
                if derived[name].get(key) != value:
                    print(f"derive.py on {name}: {key} is {value}, not {derived[name].get(key)}")
                    wrong += 1
        return wrong + check(snell, folder, derived)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("snell")
    parser.add_argument("folder")
    parser.add_argument("--most-bytes", type=float, default=float("inf"))
    arguments = parser.parse_args()
    if arguments.folder == "own":
        sys.exit(1 if check_own(arguments.snell) else 0)
    found, left_out = derive.derive_all(arguments.folder, arguments.most_bytes)
    if left_out:
        print(f"left out, as too large for a short run: {', '.join(left_out)}")
    sys.exit(1 if check(arguments.snell, arguments.folder, found) else 0)
