#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "core/base/grouping.h"
#include "core/base/rounded_to_float.h"
#include "core/io/common/bytes.h"
#include "core/io/common/write_text.h"
#include "core/io/stl/stl.h"

namespace remesh {
namespace {

constexpr std::size_t kHeaderBytes = 80;

using Floats = std::array<float, 3>;

Floats nearest_floats(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Converts a point to floats without rounding, so that the file has exactly the coordinates that were checked.
Floats exact_floats(const Vec3& v) {
  if (!is_finite(v) || rounded_to_float(v) != v)
    throw Error(Code::kInternal, Stage::kWrite, "a coordinate that is no float was to be written as binary STL");
  return nearest_floats(v);
}

/// Returns the unit normal, or zero if there is none, as is customary.
Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  // The sides are normalised first, so that their product neither overflows nor underflows.
  return normalized(cross(normalized(b - a), normalized(c - a)));
}

void append_facet(std::string& out, const TriangleMesh& mesh, FaceId f) {
  const auto& [a, b, c] = mesh.faces[f];
  const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
  out += "facet normal";
  for (const float coordinate : nearest_floats(normal_of(p, q, r))) {
    char digits[32];
    out += ' ';
    // Adding 0 removes the sign of a zero.
    out.append(digits, std::to_chars(digits, digits + sizeof digits, coordinate + 0.0F).ptr);
  }
  out += "\n outer loop\n";
  for (const Vec3* corner : {&p, &q, &r}) {
    out += "  vertex";
    append_coordinates(out, *corner);
  }
  out += " endloop\nendfacet\n";
}

/// Makes the header, which has room for 80 bytes, from the first comment. That comment is a list of entries with commas
/// between them, such as "patches=6, origin=1 2 3". The header takes the last entries first, because readers need them
/// most: the origin, for example. An entry is written as a whole or not at all, because half a number is a wrong
/// number. The header must not begin with "solid", because readers would take the file for text.
std::string header_of(const std::vector<std::string>& comments) {
  constexpr std::string_view kSeparator = ", ";
  std::string header = "binary STL";
  if (comments.empty()) return header;
  const std::string words = without_control_characters(comments.front());
  for (std::string_view rest = words; !rest.empty();) {
    const std::size_t found = rest.rfind(kSeparator);
    const std::size_t begin = found == std::string_view::npos ? 0 : found + kSeparator.size();
    const std::string_view part = rest.substr(begin);
    if (header.size() + kSeparator.size() + part.size() <= kHeaderBytes) header.append(kSeparator).append(part);
    rest = rest.substr(0, found == std::string_view::npos ? 0 : found);
  }
  return header;
}

}  // namespace

std::string write_stl(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  constexpr std::uint32_t kMaxCount = std::numeric_limits<std::uint32_t>::max();
  if (mesh.faces.size() > kMaxCount) {
    throw Error(Code::kOutputTooLarge, Stage::kWrite, "more triangles than binary STL can count").with_limit(kMaxCount);
  }
  std::string out = header_of(comments);
  out.resize(kHeaderBytes, ' ');
  out.reserve(kHeaderBytes + 4 + 50 * mesh.faces.size());
  append_little_endian(out, static_cast<std::uint32_t>(mesh.faces.size()));

  WriteProgress progress(mesh.faces.size(), control);
  for (const Triangle& face : mesh.faces) {
    progress.tick();
    const Vec3 &a = mesh.positions[face[0]], &b = mesh.positions[face[1]], &c = mesh.positions[face[2]];
    for (const Floats& v : {nearest_floats(normal_of(a, b, c)), exact_floats(a), exact_floats(b), exact_floats(c)})
      for (const float coordinate : v) append_little_endian(out, coordinate);
    append_little_endian(out, std::uint16_t{0});
  }
  return out;
}

std::optional<Boundaries> stl_boundaries(const WriterInput& input, RunControl& control) {
  const LabelChoice choice = input.writing.label;
  const bool are_divided = choice == LabelChoice::kPatch || choice == LabelChoice::kSurface ||
                           chosen_labels(input.mesh.labels, choice) != nullptr;
  if (!are_divided || input.writing.stl_solids == StlSolids::kOne) return std::nullopt;
  return Boundaries(input, control);
}

std::string write_stl_ascii(const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  const TriangleMesh& mesh = input.mesh;
  const std::optional<Boundaries> boundaries = stl_boundaries(input, control);
  const std::size_t solids = boundaries ? boundaries->size() : 1;
  const Grouping faces_of = group_by(
      mesh.faces.size(), solids, [&](std::uint32_t f) { return boundaries ? boundaries->of(FaceId(f)) : 0; }, control);
  std::string out;
  std::size_t written = 0;
  const auto share = [&] {
    return static_cast<double>(written) / static_cast<double>(std::max<std::size_t>(mesh.faces.size(), 1));
  };
  for (std::size_t solid = 0; solid < solids; ++solid) {
    const std::span<const std::uint32_t> faces = faces_of[solid];
    if (faces.empty() && boundaries) continue;
    const std::string name = boundaries ? boundaries->name(solid) : "";
    out += "solid " + name + "\n";
    const double begin = share();
    written += faces.size();
    append_elements(out, faces.size(), {begin, share()}, control,
                    [&](std::string& text, std::size_t i) { append_facet(text, mesh, FaceId(faces[i])); });
    out += "endsolid " + name + "\n";
  }
  return out;
}

}  // namespace remesh
