"""Part `surface`: refinement of a surface beside CGAL's isotropic remeshing and Gmsh, for edges of one length."""

import pathlib
import shutil
import sys

from programs import seconds

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
import dihedral  # noqa: E402
import surface_files  # noqa: E402

# Coarse, so that nothing is near what is asked for before.
INPUTS = [("bracket", 1000), ("plate", 100)]
PART_OF_DIAGONAL = 0.01
GMSH_SCRIPT = """\
Merge "{input}";
ClassifySurfaces{{30 * Pi / 180, 1, 1, Pi}};
CreateGeometry;
Mesh.MeshSizeMin = {length};
Mesh.MeshSizeMax = {length};
Mesh 2;
Save "{output}";
"""


def measure_surface(bench, table):
    for shape, faces in INPUTS:
        path = bench.input(shape, faces)
        surface = surface_files.read_surface(path)
        length = PART_OF_DIAGONAL * surface.diagonal()
        outputs = {name: bench.folder / f"{shape}_by_{name}.{ending}"
                   for name, ending in [("remesh", "obj"), ("CGAL", "obj"), ("Gmsh", "stl")]}
        works = {
            # CGAL cuts what is longer than that, too.
            "remesh": lambda: bench.remesh(path, "--max-edge-length", str(4 / 3 * length), workers=1,
                                           output=outputs["remesh"].name),
            "CGAL": lambda: bench.run(bench.program("isotropic_peer"), path, outputs["CGAL"], str(length)),
        }
        has_gmsh = shutil.which("gmsh") is not None
        if has_gmsh:
            script = write_gmsh_script(bench.folder / f"{shape}.geo", surface, length, outputs["Gmsh"])
            works["Gmsh"] = lambda: bench.run("gmsh", script, "-", "-v", "1", "-nt", "1")
        results = bench.by_turns(works)
        case = f"{shape}, edges of {PART_OF_DIAGONAL:.0%} of the diagonal, one thread"
        made = {name: surface_files.read_surface(outputs[name]) for name in works}
        a_face = {name: 1e6 * seconds(results[name]) / len(made[name].faces) for name in works}
        for name in works:
            table.add(case, name, seconds(results[name]), "s")
            table.add(case, name, len(made[name].faces), "faces")
            table.add(case, name, dihedral.least_corner(made[name]), "degrees, the least angle")
            table.add(case, name, a_face[name], "us a face")
        for name in works:
            if name != "remesh":
                table.add(case, "remesh", a_face["remesh"], "us a face", name, a_face[name])
        if not has_gmsh:
            table.leave_out(case, "Gmsh", "it could not be had")


def write_gmsh_script(path, surface, length, output):
    """Gmsh reads no OBJ: the same surface as STL, with all digits."""
    stl = path.with_suffix(".stl")
    surface_files.write_stl(surface, stl)
    path.write_text(GMSH_SCRIPT.format(input=stl, output=output, length=length))
    return path
