#include "tests/support/own_meshes.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace remesh::test {
namespace {

/// Returns the text between separators, without the blanks around it.
std::vector<std::string> cells_of(const std::string& text, char separator) {
  std::vector<std::string> cells;
  std::istringstream parts(text);
  for (std::string cell; std::getline(parts, cell, separator);) {
    const std::size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

}  // namespace

std::filesystem::path own_meshes_folder() { return std::filesystem::path(REMESHD_SOURCE_DIR) / "tests" / "data"; }

std::vector<OwnMesh> own_meshes() {
  std::ifstream readme(own_meshes_folder() / "README.md");
  std::vector<OwnMesh> all;
  for (std::string line; std::getline(readme, line);) {
    if (!line.starts_with("| `")) continue;
    // The first cell is the empty text before the first bar.
    const std::vector<std::string> cells = cells_of(line, '|');
    constexpr std::size_t kColumns = 12;
    if (cells.size() != 1 + kColumns) throw std::runtime_error("a row of another length: " + line);
    OwnMesh& mesh = all.emplace_back();
    mesh.file = cells[1].substr(1, cells[1].size() - 2);
    mesh.area = std::stod(cells[3]);
    if (cells[4] != "-") mesh.volume = std::stod(cells[4]);
    mesh.rim = std::stod(cells[5]);
    mesh.euler = std::stoi(cells[6]);
    mesh.bodies = std::stoi(cells[7]);
    mesh.patches = std::stoul(cells[8]);
    mesh.triangles = std::stoul(cells[9]);
    mesh.sharpest_deg = std::stod(cells[10]);
    mesh.precision = std::stod(cells[11]);
    if (cells[12] != "-") mesh.told = cells_of(cells[12], ',');
  }
  return all;
}

}  // namespace remesh::test
