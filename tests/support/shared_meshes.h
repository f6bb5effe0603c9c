/// Finds the collection of real meshes beside the project. The collection may be missing; tests that need it then
/// print that they skip.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace remesh::test {

std::filesystem::path shared_meshes_folder();

/// The columns of the collection's table for one file. `file` is its name within the collection.
using MeshFacts = std::map<std::string, std::string>;

/// Returns the facts of all files in the table's order. Every file has every column.
/// Output: empty if the collection is missing.
std::vector<MeshFacts> shared_meshes_facts();

}  // namespace remesh::test
