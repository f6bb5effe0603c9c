#!/usr/bin/env bash
# A VTU file may hold arrays of strings among its field data; VTK 9.1 writes and reads them. meshio 5.0.0 knows no such
# array. It neither passes the array over nor raises an error that a program could catch as one of meshio's: it prints a
# line and raises SystemExit, so the program that called meshio.read ends, unless it catches even that.
#
# Seen with Debian's python3-meshio 7.0.0-3, which is meshio 5.0.0:
#   it prints: Error: Couldn't read file strings.vtu as vtu
#              Illegal data type 'String'.
#   meshio.read raises SystemExit(1)
#
# This script fetches that package and what it imports into a temporary folder, reads a valid file, and fails if the
# behaviour is no longer so. It needs Debian bookworm's package lists and its Python 3.11, and changes nothing outside of
# the folder.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

packages=(python3-meshio=7.0.0-3 python3-numpy=1:1.24.2-1+deb12u1 python3-rich=13.3.1-1 python3-pygments
  python3-markdown-it python3-mdurl python3-importlib-metadata python3-zipp libblas3 liblapack3 libgfortran5
  libquadmath0)
apt-get download -qq "${packages[@]}" 2>/dev/null
for package in *.deb; do dpkg -x "$package" root; done

cat >strings.vtu <<'VTU'
<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <UnstructuredGrid>
    <FieldData>
      <Array type="String" Name="names" NumberOfTuples="2" format="ascii">
        105 110 108 101 116 0 119 97 108 108 0
      </Array>
    </FieldData>
    <Piece NumberOfPoints="3" NumberOfCells="1">
      <Points>
        <DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0</DataArray>
      </Points>
      <Cells>
        <DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>
        <DataArray type="Int64" Name="offsets" format="ascii">3</DataArray>
        <DataArray type="UInt8" Name="types" format="ascii">5</DataArray>
      </Cells>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
VTU
# The same file without the array of strings, which meshio has to read.
sed '/<FieldData>/,/<\/FieldData>/d' strings.vtu >plain.vtu

cat >read.py <<'PYTHON'
import meshio

assert meshio.__version__ == "5.0.0", meshio.__version__
assert len(meshio.read("plain.vtu").cells[0].data) == 1
try:
    meshio.read("strings.vtu")
except SystemExit as end:
    print("meshio", meshio.__version__, "raised SystemExit with", end.code)
except Exception as error:
    raise SystemExit(f"it has changed: {type(error).__name__}: {error}")
else:
    raise SystemExit("it has changed: the file was read")
PYTHON
libraries=$folder/root/usr/lib/x86_64-linux-gnu
PYTHONPATH=$folder/root/usr/lib/python3/dist-packages LD_LIBRARY_PATH=$libraries:$libraries/blas:$libraries/lapack \
  /usr/bin/python3.11 -B -S read.py | tee output
grep -q "Illegal data type 'String'" output
grep -q "raised SystemExit with 1" output
