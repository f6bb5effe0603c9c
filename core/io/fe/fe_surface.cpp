#include "core/io/fe/fe_surface.h"

#include <charconv>

namespace remesh {

void FeSurface::add_node(std::uint64_t tag, const Vec3& position, std::uint64_t line) {
  if (positions_.size() == limits_.max_vertices)
    throw too_large_error(Place::line(line), "vertices", limits_.max_vertices);
  if (!is_finite(position))
    throw read_error(Place::line(line), Code::kNonfiniteCoordinate, "a node with a coordinate that is not finite");
  positions_.push_back(position);
  last_line_ = line;
  nodes_.add(tag);
}

void FeSurface::add_face(std::uint64_t tag, std::span<const std::uint64_t> corners, std::uint64_t line) {
  if (faces_.size() == limits_.max_faces) throw too_large_error(Place::line(line), "faces", limits_.max_faces);
  Face& face = faces_.emplace_back();
  std::copy(corners.begin(), corners.end(), face.corners.begin());
  face.line = line;
  last_line_ = line;
  face_tags_.add(tag);
}

void FeSurface::drop(std::string_view kind) {
  constexpr std::size_t kMaxKinds = 32, kMaxKind = 40;
  const std::string_view name = kind.substr(0, kMaxKind);
  const auto known = dropped_.find(name);
  if (known != dropped_.end()) {
    ++known->second;
  } else if (dropped_.size() < kMaxKinds) {
    dropped_.emplace(name, 1);
  }
}

const NodeTags& FeSurface::sorted_faces() {
  if (const auto twice = face_tags_.sort(control_))
    throw read_error(Place::line(last_line_), Code::kInvalidMesh,
                     "two elements have the number " + std::to_string(*twice & UINT32_MAX));
  return face_tags_;
}

ReadResult FeSurface::take() {
  if (const auto twice = nodes_.sort(control_))
    throw read_error(Place::line(last_line_), Code::kInvalidMesh,
                     "two nodes have the number " + std::to_string(*twice & UINT32_MAX));
  builder_.announce(positions_.size(), faces_.size(), positions_.size(), faces_.size(), Place::line(1));
  builder_.mesh().positions.items() = std::move(positions_);
  for (const Face& face : faces_) {
    tick(content_.size());
    const Place place = Place::line(face.line);
    const std::uint64_t corners = face.corners[3] == 0 ? 3 : 4;
    builder_.begin_face(corners, place);
    for (std::uint64_t i = 0; i < corners; ++i) {
      const std::int64_t vertex = nodes_.find(face.corners[i]);
      if (vertex < 0) {
        throw read_error(place, Code::kIndexOutOfRange,
                         "there is no node " + std::to_string(face.corners[i] & UINT32_MAX))
            .at_element(builder_.mesh().face_count() - 1);
      }
      builder_.add_corner(vertex, place);
    }
  }
  ReadResult result;
  result.mesh = builder_.take();
  for (const auto& [kind, count] : dropped_)
    record_dropped("elements " + cited(kind) + " were dropped", count, result.diagnostics);
  record_padding(content_, result.diagnostics);
  return result;
}

std::uint64_t parse_tag(std::string_view token, const char* what, std::uint64_t line) {
  std::uint32_t tag = 0;
  const char* const end = token.data() + token.size();
  const auto [stop, status] = std::from_chars(token.data(), end, tag);
  constexpr std::uint32_t kMost = std::uint32_t{1} << 31;
  if (status != std::errc() || stop != end || tag == 0 || tag > kMost)
    throw read_error(Place::line(line), Code::kInvalidMesh, std::string(what) + " was expected, found " + cited(token));
  return tag;
}

double parse_fortran_coordinate(std::string_view token, std::uint64_t line) {
  if (token.empty()) return 0;
  // The first sign that is not that of the number or of its exponent begins the exponent.
  const std::size_t mark = token.find_first_of("dDeE+-", 1);
  if (mark == std::string_view::npos || token[mark] == 'e' || token[mark] == 'E')
    return parse_coordinate(token, Place::line(line));
  const bool is_letter_mark = token[mark] == 'd' || token[mark] == 'D';
  std::string number(token.substr(0, mark));
  number.append("e").append(token.substr(mark + (is_letter_mark ? 1 : 0)));
  return parse_coordinate(number, Place::line(line));
}

}  // namespace remesh
