#include "tests/support/shared_meshes.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>

namespace remesh::test {

std::filesystem::path shared_meshes_folder() {
  const char* folder = std::getenv("REMESHD_CORPUS");
  if (folder != nullptr && *folder != '\0') return folder;
  return std::filesystem::path(REMESHD_SOURCE_DIR) / ".." / "shared" / "meshes";
}

bool is_corpus_required() {
  const char* value = std::getenv("REMESHD_REQUIRE_CORPUS");
  return value != nullptr && std::string_view(value) == "1";
}

bool has_shared_mesh(const std::string& name) {
  const std::filesystem::path path = name.empty() ? shared_meshes_folder() : shared_meshes_folder() / name;
  if (std::filesystem::exists(path)) return true;
  // These macros return from the function in which they stand.
  if (is_corpus_required()) {
    [&] { FAIL() << "there is no " << path << ", and REMESHD_REQUIRE_CORPUS is 1"; }();
  } else {
    [&] { GTEST_SKIP() << "NOT TESTED: there is no " << path; }();
  }
  return false;
}

std::vector<TableRow> read_table(const std::filesystem::path& path) {
  std::ifstream table(path);
  std::vector<TableRow> all;
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
    TableRow& named = all.emplace_back();
    for (std::size_t i = 0; i < columns.size(); ++i) named[columns[i]] = cells[i];
  }
  return all;
}

std::vector<MeshFacts> shared_meshes_facts() { return read_table(shared_meshes_folder() / "facts.tsv"); }

}  // namespace remesh::test
