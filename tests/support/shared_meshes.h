/// Where the collection of real meshes lies, beside the project. It need not be there: tests that want it say loudly
/// that they skip.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace remesh::test {

std::filesystem::path shared_meshes_folder();

/// What the collection's table says of a file, by column; `file` is its name within the collection.
using MeshFacts = std::map<std::string, std::string>;

/// Of all files, in the table's order; every one has every column. Empty if the collection is not there.
std::vector<MeshFacts> shared_meshes_facts();

}  // namespace remesh::test
