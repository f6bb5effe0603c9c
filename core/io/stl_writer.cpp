#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/io/bytes.h"
#include "core/io/stl.h"
#include "core/io/write_text.h"

namespace remesh {
namespace {

constexpr std::size_t kHeader = 80;

using Floats = std::array<float, 3>;

[[noreturn]] void refuse(const std::string& reason, const std::string& other_way = "") {
  throw Error(Code::kNotAcceptable, Stage::kWrite,
              reason + ", the only numbers that STL has; ask for another format" + other_way)
      .for_option("format");
}

Floats to_floats(const Vec3& v) {
  const Floats rounded{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  if (!std::all_of(rounded.begin(), rounded.end(), [](float f) { return std::isfinite(f); }))
    refuse("a coordinate is beyond the largest float");
  return rounded;
}

/// A triangle whose corners come to lie in one place is no triangle any more: not the mesh that was verified.
void check_corners(const std::array<Floats, 3>& corners) {
  if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
    refuse("two corners of a triangle are one place in floats", ", or for longer edges by min_edge_length");
}

/// Unit normal; zero, as is the custom, where there is none.
Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  // Unit vectors first: their product neither overflows nor underflows.
  return normalized(cross(normalized(b - a), normalized(c - a)));
}

}  // namespace

std::string write_stl(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  constexpr std::uint32_t kMaxCount = std::numeric_limits<std::uint32_t>::max();
  if (mesh.faces.size() > kMaxCount) {
    throw Error(Code::kOutputTooLarge, Stage::kWrite, "more triangles than STL counts").with_limit(kMaxCount);
  }
  // Readers take a header that begins with "solid" for text.
  std::string out = "binary STL, coordinates rounded to floats";
  if (!comments.empty()) out += "; " + without_control_characters(comments.front());
  out.resize(kHeader, ' ');
  out.reserve(kHeader + 4 + 50 * mesh.faces.size());
  append_little_endian(out, static_cast<std::uint32_t>(mesh.faces.size()));

  WriteProgress progress(mesh.faces.size(), control);
  for (const Triangle& face : mesh.faces) {
    progress.tick();
    const Vec3 &a = mesh.positions[face[0]], &b = mesh.positions[face[1]], &c = mesh.positions[face[2]];
    const std::array<Floats, 3> corners{to_floats(a), to_floats(b), to_floats(c)};
    check_corners(corners);
    for (const Floats& v : {to_floats(normal_of(a, b, c)), corners[0], corners[1], corners[2]})
      for (const float coordinate : v) append_little_endian(out, coordinate);
    append_little_endian(out, std::uint16_t{0});
  }
  return out;
}

}  // namespace remesh
