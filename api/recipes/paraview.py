"""Tells what a remeshed part has as cell data, by VTK as ParaView has it inside: paraview.py PART

In ParaView itself, open part.vtu. The arrays are patch, surface, group and the like, and the quality of each triangle; the
names of groups are those of the components of `group_names`.
"""

import os
import subprocess
import sys

import vtk

subprocess.run([os.environ.get("REMESH", "remesh"), sys.argv[1], "-o", "part.vtu"], check=True)
reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName("part.vtu")
reader.Update()
grid = reader.GetOutput()
data = grid.GetCellData()
print(grid.GetNumberOfCells(), "triangles with", ", ".join(data.GetArrayName(i) for i in range(data.GetNumberOfArrays())))
names = grid.GetFieldData().GetArray("group_names")
if names is not None:
    print("groups:", ", ".join(names.GetComponentName(i) for i in range(names.GetNumberOfComponents())))
