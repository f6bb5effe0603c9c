#include "tests/support/shared_meshes.h"

namespace remesh::test {

std::filesystem::path shared_meshes_folder() {
  return std::filesystem::path(REMESHD_SOURCE_DIR) / ".." / "shared" / "meshes";
}

}  // namespace remesh::test
