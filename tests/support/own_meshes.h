/// Finds the small meshes of tests/data, and what geometry says of each.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace remesh::test {

/// Returns the folder tests/data of the sources.
std::filesystem::path own_meshes_folder();

/// One row of the table in tests/data/README.md, which tells what the columns mean.
struct OwnMesh {
  std::string file;
  double area = 0;
  std::optional<double> volume;  ///< empty if the mesh is open
  double rim = 0;                ///< the length of the edges with one face
  int euler = 0;
  int bodies = 0;
  std::size_t patches = 0;
  std::size_t triangles = 0;      ///< the number of them without refinement
  double sharpest_deg = 0;        ///< the smallest angle between two sides of a patch
  double precision = 0;           ///< relative
  std::vector<std::string> told;  ///< names of diagnostics; empty if the mesh is without defect
};

/// Returns the rows of the table in its order.
std::vector<OwnMesh> own_meshes();

}  // namespace remesh::test
