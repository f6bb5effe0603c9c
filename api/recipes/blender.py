"""Opens a remeshed part in Blender: blender --python blender.py -- PART

The materials of Blender are boundaries for mesh programs by `--label material`, on the way out of Blender.
"""

import subprocess
import sys

import bpy

part = sys.argv[sys.argv.index("--") + 1]
subprocess.run(["remesh", part, "-o", "part.obj"], check=True)
bpy.ops.wm.obj_import(filepath="part.obj", import_vertex_groups=True)
