#!/usr/bin/env python3
"""Checks that the rooms include only what the design lets them (README.md, "Rooms").

  packaging/check_includes.py [ROOT]       exit 1 and one line a breach
  packaging/check_includes.py --self-test  shows that a breach of each kind is found
"""

import pathlib
import re
import sys
import tempfile

# Rooms of core: what the row names; the rooms' own includes follow from these. base is everywhere.
CORE = {
    "base": [],
    "geometry": ["base"],
    "voxels": ["geometry"],
    "collision": ["voxels"],
    "dynamics": ["collision"],
    "haptics": ["geometry"],
    "devices": ["haptics"],
    "scene": ["dynamics", "haptics"],
    "simulation": ["scene"],
    "session": ["simulation"],
    "trade": ["session"],
}

# Value types of core that imaging may use.
IMAGING_CORE = re.compile(r"core/(base|geometry)/|core/voxels/label_grid\.h$")

OPENGL = r"GL/|GLES|GLFW/|glad/"
IMGUI = r"imgui"
VTK = r"vtk"
VTK_RENDERING = r"vtk(Render|OpenGL|GenericOpenGL|Actor|Volume(Mapper|Property)?\.h|Camera|PolyDataMapper)"
ITK = r"itk"
DCMTK = r"dcmtk/"

# Libraries that a room never includes.
NEVER = {
    "core": [OPENGL, IMGUI, VTK, ITK, DCMTK],
    "imaging": [OPENGL, IMGUI, VTK_RENDERING],
    "ui": [ITK, DCMTK],
}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def allowed_core(room):
    found, todo = {room, "base"}, [room]
    while todo:
        for next_room in CORE[todo.pop()]:
            if next_room not in found:
                found.add(next_room)
                todo.append(next_room)
    return found


def breach_of_room(path, target):
    """Why the file at `path` (parts) may not include `target`, or None."""
    top, goal = path[0], target.split("/")
    if goal[0] not in ("core", "imaging", "ui", "app", "tests"):
        return None
    if top == "core":
        if goal[0] != "core":
            return "core includes only core"
        if len(goal) < 3 or goal[1] not in CORE or path[1] not in CORE:
            return "a room that the design does not name"
        if goal[1] not in allowed_core(path[1]):
            return "core/%s may not include core/%s" % (path[1], goal[1])
    if top == "imaging" and goal[0] != "imaging" and not IMAGING_CORE.match(target):
        return "imaging includes only imaging and core's value types"
    if top == "ui":
        if goal[0] in ("app", "tests"):
            return "ui does not include %s" % goal[0]
        if target.startswith("core/devices/"):
            return "ui never touches devices"
    if top == "app" and goal[0] == "tests":
        return "the program does not include tests"
    return None


def breaches(root):
    found = []
    for top in ("core", "imaging", "ui", "app"):
        for file in sorted((root / top).rglob("*")):
            if file.suffix not in (".h", ".cpp"):
                continue
            path = file.relative_to(root).parts
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                target = match.group(2)
                why = breach_of_room(path, target)
                if why is None and match.group(1) == '"' and target.startswith("."):
                    why = "includes are relative to the repository's root"
                for library in NEVER.get(top, []):
                    if why is None and re.match(library, target):
                        why = "%s never includes this library" % top
                if why:
                    found.append("%s:%d: %s: %s" % ("/".join(path), number, target, why))
    return found


SELF_TEST = [
    # file, include line, is a breach
    ("core/geometry/a.h", '#include "core/base/error.h"', False),
    ("core/geometry/a.h", '#include "core/voxels/label_grid.h"', True),
    ("core/scene/a.cpp", '#include "core/collision/contact.h"', False),
    ("core/haptics/a.cpp", '#include "core/collision/contact.h"', True),
    ("core/trade/a.cpp", '#include "core/voxels/voxel_tree.h"', False),
    ("core/voxels/a.cpp", "#include <vtkPolyData.h>", True),
    ("core/voxels/a.cpp", '#include "imaging/volume.h"', True),
    ("core/voxels/a.cpp", "#include <Eigen/Core>", False),
    ("imaging/a.cpp", '#include "core/voxels/label_grid.h"', False),
    ("imaging/a.cpp", '#include "core/voxels/voxel_tree.h"', True),
    ("imaging/a.cpp", "#include <vtkRenderer.h>", True),
    ("imaging/a.cpp", "#include <vtkFlyingEdges3D.h>", False),
    ("imaging/a.cpp", "#include <GL/gl.h>", True),
    ("ui/a.cpp", '#include "core/simulation/snapshot.h"', False),
    ("ui/a.cpp", '#include "core/devices/hand.h"', True),
    ("ui/a.cpp", '#include "app/desktop.h"', True),
    ("ui/a.cpp", "#include <dcmtk/dcmdata/dctk.h>", True),
    ("app/a.cpp", '#include "core/devices/hand.h"', False),
    ("app/a.cpp", '#include "../core/devices/hand.h"', True),
]


def self_test():
    for name, line, is_breach in SELF_TEST:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            file = root / name
            file.parent.mkdir(parents=True)
            file.write_text("#pragma once\n" + line + "\n", encoding="utf-8")
            if bool(breaches(root)) != is_breach:
                print("self-test: %s: %s: %s" % (name, line, "missed" if is_breach else "wrongly found"))
                return 1
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    found = breaches(root.resolve())
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
