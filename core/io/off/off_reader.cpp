#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include "core/io/common/bytes.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/common/text_lines.h"
#include "core/io/off/off.h"

namespace remesh {
namespace {

constexpr std::size_t kDimensions = 3;

/// Counts the vertices and the faces that have values beyond those that are read.
struct DroppedValues {
  Diagnostic of_vertices{DiagnosticCode::kAttributeDropped, 0, {}, ""};
  Diagnostic of_faces{DiagnosticCode::kAttributeDropped, 0, {}, ""};

  void report(std::vector<Diagnostic>& diagnostics) {
    report(
        of_vertices,
        "values after x y z (normals, colours, texture coordinates) were dropped; number of vertices that had them: ",
        diagnostics);
    report(of_faces,
           "values after the corners of faces (colours) were dropped; number of faces that had them: ", diagnostics);
  }

 private:
  static void report(Diagnostic& found, const char* message, std::vector<Diagnostic>& diagnostics) {
    if (found.count == 0) return;
    found.message = message + std::to_string(found.count);
    diagnostics.push_back(std::move(found));
  }
};

class OffTextReader {
 public:
  OffTextReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), lines_(content), builder_(limits, control) {}

  ReadResult read() {
    read_head();
    for (std::uint64_t v = 0; v < vertices_; ++v) {
      next_line("vertices", v, vertices_);
      read_vertex(v);
    }
    for (std::uint64_t f = 0; f < faces_; ++f) {
      next_line("faces", f, faces_);
      read_face(f);
    }
    if (find_line()) throw error("text after the last face: " + cited(rest_));
    ReadResult result;
    result.mesh = builder_.take();
    dropped_.report(result.diagnostics);
    record_padding(content_, result.diagnostics);
    return result;
  }

 private:
  void read_head() {
    if (!find_line()) throw error("not OFF: the text is empty");
    const auto kind = off_kind(next_token(rest_));
    if (!kind) throw error("not OFF: the first word is none of OFF, COFF, NOFF, STOFF, ...");
    if (kind->is_homogeneous) throw error("homogeneous coordinates (4OFF) are not read");
    if (kind->has_dimension) {
      if (rest_.empty()) next_line();
      if (take_count("dimension") != kDimensions) throw error("the vertices must have 3 dimensions");
    }
    if (trim(rest_).empty()) next_line();
    vertices_ = take_count("number of vertices");
    faces_ = take_count("number of faces");
    if (!trim(rest_).empty()) (void)take_count("number of edges");
    if (!trim(rest_).empty()) throw error("more than three counts: " + cited(rest_));
    // The shortest line has three numbers and its end.
    constexpr std::size_t kMinLine = 6;
    builder_.announce(vertices_, faces_, content_.size() / kMinLine, content_.size() / kMinLine, here());
  }

  void read_vertex(std::uint64_t vertex) {
    Vec3 position;
    for (std::size_t axis = 0; axis < kDimensions; ++axis) {
      const std::string_view token = next_token(rest_);
      if (token.empty()) throw error("a vertex with fewer than three coordinates").at_element(vertex);
      position[static_cast<int>(axis)] = parse_coordinate(token, here());
    }
    builder_.add_vertex(position, here());
    if (!trim(rest_).empty()) dropped_.of_vertices.add(vertex);
  }

  void read_face(std::uint64_t face) {
    const std::uint64_t corners = take_count("number of a face's corners");
    builder_.begin_face(corners, here());
    for (std::uint64_t i = 0; i < corners; ++i) {
      builder_.tick(lines_.offset(), content_.size());
      const std::string_view token = next_token(rest_);
      if (token.empty()) {
        throw error("a face with " + std::to_string(i) + " of its " + std::to_string(corners) + " corners")
            .at_element(face);
      }
      builder_.add_corner(parse<std::int64_t>(token, "vertex number"), here());
    }
    if (!trim(rest_).empty()) dropped_.of_faces.add(face);
  }

  /// Goes to the next line that is neither blank nor a comment, and removes a comment at its end.
  bool find_line() {
    while (lines_.next()) {
      rest_ = lines_.line();
      const std::size_t comment = rest_.find('#');
      if (comment == std::string_view::npos) lines_.check_is_text();
      rest_ = trim(rest_.substr(0, comment));
      if (!rest_.empty()) return true;
    }
    return false;
  }
  void next_line() {
    if (!find_line()) throw error("the text ends inside the header, which has the numbers of vertices and faces");
  }
  void next_line(const char* what, std::uint64_t done, std::uint64_t of) {
    builder_.tick(lines_.offset(), content_.size());
    if (find_line()) return;
    throw error("the text ends after " + std::to_string(done) + " of " + std::to_string(of) + " " + what);
  }

  std::uint64_t take_count(const char* what) { return parse<std::uint64_t>(next_token(rest_), what); }

  template <class Integer>
  Integer parse(std::string_view token, const char* what) const {
    Integer value = 0;
    const char* const end = token.data() + token.size();
    const auto [stop, status] = std::from_chars(token.data(), end, value);
    if (status == std::errc() && stop == end) return value;
    throw error(std::string("a ") + what + " was expected, found " + cited(token));
  }

  Place here() const { return Place::line(lines_.number()); }
  Error error(const std::string& message) const { return read_error(here(), Code::kInvalidMesh, message); }

  std::string_view content_;
  TextLines lines_;
  MeshBuilder builder_;
  DroppedValues dropped_;
  std::string_view rest_;
  std::uint64_t vertices_ = 0;
  std::uint64_t faces_ = 0;
};

/// The head of `OFF BINARY`: the kind that its first word states, and its size.
struct BinaryHead {
  OffKind kind;
  std::size_t size;
};
std::optional<BinaryHead> binary_head(std::string_view content) {
  constexpr std::size_t kLongest = 64;
  const std::size_t end = content.substr(0, kLongest).find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  std::string_view line = content.substr(0, end);
  if (line.ends_with('\r')) line.remove_suffix(1);
  const auto kind = off_kind(next_token(line));
  if (!kind || trim(line) != "BINARY") return std::nullopt;
  return BinaryHead{*kind, end + 1};
}

ReadResult read_binary(std::string_view content, const BinaryHead& head, const ReadLimits& limits,
                       RunControl& control) {
  constexpr std::size_t kNumber = 4;
  ByteReader bytes(content, head.size, ByteOrder::kBig);
  const auto invalid = [&](const std::string& message) {
    return read_error(bytes.place(), Code::kInvalidMesh, message);
  };
  if (head.kind.is_homogeneous) throw invalid("homogeneous coordinates (4OFF) are not read");
  if (head.kind.has_dimension && bytes.take<std::int32_t>() != kDimensions) {
    throw invalid("the vertices must have 3 dimensions");
  }
  const auto take_count = [&](const char* what) {
    const std::int32_t count = bytes.take<std::int32_t>();
    if (count < 0) throw invalid(std::string("a negative number of ") + what);
    return static_cast<std::uint64_t>(count);
  };
  const Place counts = bytes.place();
  const std::uint64_t vertices = take_count("vertices");
  const std::uint64_t faces = take_count("faces");
  (void)take_count("edges");

  const std::size_t extra =
      kNumber * ((head.kind.has_normal ? 3 : 0) + (head.kind.has_colour ? 4 : 0) + (head.kind.has_texture ? 2 : 0));
  const std::size_t vertex_size = kNumber * kDimensions + extra;
  constexpr std::size_t kMinFace = kNumber * 5;  // number of corners, three corners, number of colour values
  MeshBuilder builder(limits, control);
  builder.announce(vertices, faces, bytes.left() / vertex_size, bytes.left() / kMinFace, counts);
  DroppedValues dropped;
  for (std::uint64_t v = 0; v < vertices; ++v) {
    builder.tick(bytes.offset(), content.size());
    const Place place = bytes.place();
    Vec3 position;
    for (int axis = 0; axis < 3; ++axis) position[axis] = bytes.take<float>();
    builder.add_vertex(position, place);
    bytes.skip(extra);
    if (extra > 0) dropped.of_vertices.add(v);
  }
  for (std::uint64_t f = 0; f < faces; ++f) {
    const Place place = bytes.place();
    const std::uint64_t corners = take_count("corners");
    builder.begin_face(corners, place);
    for (std::uint64_t i = 0; i < corners; ++i) {
      builder.tick(bytes.offset(), content.size());
      builder.add_corner(bytes.take<std::int32_t>(), place);
    }
    const std::uint64_t values = take_count("values of colour");
    bytes.skip(values * kNumber);
    if (values > 0) dropped.of_faces.add(f);
  }
  ReadResult result;
  record_trailing_bytes(content, bytes.offset(), kMinFace, result.diagnostics);
  result.mesh = builder.take();
  dropped.report(result.diagnostics);
  return result;
}

}  // namespace

std::optional<OffKind> off_kind(std::string_view word) {
  OffKind kind;
  const auto take = [&](std::string_view prefix, bool& has) {
    has = word.starts_with(prefix);
    if (has) word.remove_prefix(prefix.size());
  };
  take("ST", kind.has_texture);
  take("C", kind.has_colour);
  take("N", kind.has_normal);
  take("4", kind.is_homogeneous);
  take("n", kind.has_dimension);
  return word == "OFF" ? std::optional(kind) : std::nullopt;
}

ReadResult read_off(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  if (const auto head = binary_head(content)) return read_binary(content, *head, limits, control);
  return OffTextReader(content, limits, control).read();
}

}  // namespace remesh
