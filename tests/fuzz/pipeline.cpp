// The whole pipeline on tiny meshes: bytes become points of a coarse grid, so that they coincide, line up and cross,
// and faces over them. Whatever they are, the answer is verified, or an error of the contract.
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/remesh.h"
#include "tests/fuzz/fuzz.h"

namespace {

using namespace remesh;

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}
  bool is_empty() const { return at_ == end_; }
  std::uint8_t take() { return at_ == end_ ? std::uint8_t{0} : *at_++; }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

PolygonMesh mesh_from(Bytes& bytes) {
  constexpr int kGrid = 5;  // points a side
  constexpr std::size_t kMaxFaces = 24;
  PolygonMesh mesh;
  const std::size_t vertices = 3 + bytes.take() % 14;
  const bool is_noisy = bytes.take() % 4 == 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    Vec3 position;
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint8_t byte = bytes.take();
      position[axis] = byte % kGrid + (is_noisy ? 1e-9 * (byte / kGrid) : 0);
    }
    mesh.positions.push_back(position);
  }
  while (!bytes.is_empty() && mesh.face_count() < kMaxFaces) {
    const int corners = 3 + bytes.take() % 4 / 2;
    for (int i = 0; i < corners; ++i) mesh.corners.emplace_back(static_cast<std::uint32_t>(bytes.take() % vertices));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  return mesh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  Options options;
  const std::uint8_t flags = bytes.take();
  options.refine = flags % 2 == 1;
  options.keep_boundary_vertices = flags / 2 % 2 == 1;
  options.split_boundaries = flags / 4 % 2 == 0;
  options.repair.self_intersections = flags / 8 % 2 == 1;
  options.repair.make_union = flags / 16 % 2 == 1;
  options.max_output_faces = 2000;
  const PolygonMesh mesh = mesh_from(bytes);
  RunControl control;
  try {
    const Result result = remesh_surface(mesh, options, RunSettings{}, control);
    fuzz::require(result.report.verified.all_true(), "a result that is not verified");
  } catch (const Error& error) {
    const bool is_expected = error.code == Code::kEmptyMesh || error.code == Code::kOutputTooLarge;
    fuzz::require(is_expected, std::string(code_name(error.code)) + ": " + error.what());
  }
  return 0;
}
