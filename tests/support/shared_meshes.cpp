#include "tests/support/shared_meshes.h"

#include <fstream>
#include <sstream>

namespace remesh::test {

std::filesystem::path shared_meshes_folder() {
  return std::filesystem::path(REMESHD_SOURCE_DIR) / ".." / "shared" / "meshes";
}

std::vector<MeshFacts> shared_meshes_facts() {
  std::ifstream table(shared_meshes_folder() / "facts.tsv");
  std::vector<MeshFacts> all;
  std::vector<std::string> columns;
  for (std::string line; std::getline(table, line);) {
    std::istringstream row(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(row, cell, '\t');) cells.push_back(cell);
    if (columns.empty()) {
      columns = cells;
      continue;
    }
    cells.resize(columns.size());
    MeshFacts& facts = all.emplace_back();
    for (std::size_t i = 0; i < columns.size(); ++i) facts[columns[i]] = cells[i];
  }
  return all;
}

}  // namespace remesh::test
