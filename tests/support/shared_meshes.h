/// Where the collection of real meshes lies, beside the project. It need not be there: tests that want it say loudly
/// that they skip.
#pragma once

#include <filesystem>

namespace remesh::test {

std::filesystem::path shared_meshes_folder();

}  // namespace remesh::test
