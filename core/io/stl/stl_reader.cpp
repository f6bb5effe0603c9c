#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <utility>

#include "core/base/stoppable.h"
#include "core/io/common/bytes.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/text_lines.h"
#include "core/io/stl/stl.h"
#include "core/mesh/equal_places.h"

namespace remesh {
namespace {

constexpr std::size_t kHeader = 80;
constexpr std::size_t kBeginOfRecords = kHeader + 4;
constexpr std::size_t kRecord = 50;  // a normal, three vertices, two bytes of attributes
constexpr std::size_t kVector = 3 * sizeof(float);
/// Number of faces between two checks for cancellation.
constexpr std::size_t kTriangleStep = 1 << 14;

/// Makes a mesh from the corners of its triangles. Equal positions become one vertex, numbered by first appearance.
PolygonMesh joined(std::vector<Vec3> positions, const ReadLimits& limits, RunControl& control) {
  if (positions.empty()) throw Error(Code::kEmptyMesh, Stage::kRead, "the file has no facet");
  const std::size_t n = positions.size();
  PolygonMesh mesh;
  mesh.corners.resize(n);
  std::vector<std::uint32_t> first(n);
  if (!find_equal_by_hash(positions, {}, first, control)) find_equal_by_sort(positions, {}, first, control);
  StopCheck check(control);
  for (std::uint32_t i = 0; i < n; ++i) {
    check();
    mesh.corners[i] = first[i] == i ? mesh.positions.push_back(positions[i]) : mesh.corners[first[i]];
  }
  if (mesh.vertex_count() > limits.max_vertices) {
    throw Error(Code::kMeshTooLarge, Stage::kRead,
                "more different vertices than the " + std::to_string(limits.max_vertices) + " allowed")
        .with_limit(limits.max_vertices);
  }
  mesh.face_begin.resize(n / 3 + 1);
  for (std::size_t f = 0; f < mesh.face_begin.size(); ++f) mesh.face_begin[f] = static_cast<std::uint32_t>(3 * f);
  return mesh;
}

ReadResult read_binary(std::string_view content, const ReadLimits& limits, RunControl& control) {
  if (content.size() < kBeginOfRecords) throw truncated_error(content.size(), "binary STL begins with 84 bytes");
  const std::uint64_t count = load<std::uint32_t>(content.data() + kHeader, ByteOrder::kLittle);
  const std::uint64_t complete = (content.size() - kBeginOfRecords) / kRecord;
  if (count > complete) {
    throw truncated_error(content.size(), "the count says " + std::to_string(count) + " triangles, there are " +
                                              std::to_string(complete));
  }
  if (count > limits.max_faces) throw too_large_error(Place::byte(kHeader), "faces", limits.max_faces);

  ReadResult result;
  Diagnostic attributes{DiagnosticCode::kAttributeDropped, 0, {}, ""};
  std::vector<Vec3> positions;
  positions.reserve(static_cast<std::size_t>(3 * count));
  for (std::uint64_t f = 0; f < count; ++f) {
    if (f % kTriangleStep == 0) control.progress(static_cast<double>(f) / static_cast<double>(count));
    const std::size_t record = kBeginOfRecords + kRecord * static_cast<std::size_t>(f);
    const char* at = content.data() + record + kVector;
    for (int corner = 0; corner < 3; ++corner) {
      Vec3 position;
      for (int axis = 0; axis < 3; ++axis, at += sizeof(float)) position[axis] = load<float>(at, ByteOrder::kLittle);
      if (!is_finite(position)) {
        throw read_error(Place::byte(static_cast<std::uint64_t>(at - content.data()) - kVector),
                         Code::kNonfiniteCoordinate, "a vertex with a coordinate that is not finite")
            .at_element(f);
      }
      positions.push_back(position);
    }
    if (load<std::uint16_t>(at, ByteOrder::kLittle) != 0) attributes.add(f);
  }
  record_trailing_bytes(content, kBeginOfRecords + kRecord * static_cast<std::size_t>(count), kRecord,
                        result.diagnostics);
  if (attributes.count > 0) {
    attributes.message = "attribute bytes (colours) were dropped; number of triangles that had them: " +
                         std::to_string(attributes.count);
    result.diagnostics.push_back(std::move(attributes));
  }
  result.mesh = joined(std::move(positions), limits, control);
  return result;
}

class TextReader {
 public:
  TextReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), lines_(content), limits_(limits), control_(control) {}

  ReadResult read() {
    while (next_line()) take_line();
    // Some programs never end a solid, so a missing end does not mean that the last solid is incomplete.
    if (state_ != State::kOutside && state_ != State::kSolid) throw error("the text ends inside a facet");
    if (solids_.empty()) throw error("not STL: there is no \"solid\"");
    ReadResult result;
    result.mesh = joined(std::move(positions_), limits_, control_);
    label(result.mesh);
    record_padding(content_, result.diagnostics);
    return result;
  }

 private:
  enum class State { kOutside, kSolid, kFacet, kLoop, kLoopEnded };

  struct Solid {
    std::string name;
    std::size_t first_face;
  };

  bool next_line() {
    if (!lines_.next()) return false;
    if (++ticks_ % kTriangleStep == 0) {
      control_.progress(static_cast<double>(lines_.offset()) / static_cast<double>(content_.size()));
    }
    return true;
  }

  void take_line() {
    std::string_view rest = lines_.line();
    const std::string_view word = next_token(rest);
    // Names and comments may be in any encoding and contain anything.
    if ((word.empty() && !lines_.control_character()) || is_comment(word)) return;
    if (is(word, "solid") && (state_ == State::kOutside || state_ == State::kSolid)) return begin_solid(rest);
    if (state_ == State::kSolid && is_end_of("solid", word, rest)) {
      state_ = State::kOutside;
      return;
    }
    lines_.check_is_text();
    if (is_header_allowed() && !is_keyword(word)) return;
    take_words(word, rest);
  }

  /// True if lines without a keyword are accepted here. Some programs write such lines before the first solid, or
  /// between a solid's name and its first facet.
  bool is_header_allowed() const {
    if (state_ == State::kOutside) return solids_.empty();
    return state_ == State::kSolid && solids_.back().first_face == positions_.size() / 3;
  }

  void begin_solid(std::string_view rest) {
    const std::string_view name = trim(rest);
    if (name.size() > kMaxNameLength) {
      throw error("a name of more than " + std::to_string(kMaxNameLength) + " bytes");
    }
    solids_.push_back({std::string(name), positions_.size() / 3});
    state_ = State::kSolid;
  }

  /// Reads all keywords of a line. Nearly all files have one keyword per line, but some have several.
  void take_words(std::string_view word, std::string_view rest) {
    for (; !word.empty() && !is_comment(word); word = next_token(rest)) take_word(word, rest);
  }

  /// Reads a keyword and its values. Text after a keyword that ends something is skipped.
  void take_word(std::string_view word, std::string_view& rest) {
    if (state_ == State::kSolid && is(word, "facet")) {
      if (positions_.size() / 3 >= limits_.max_faces) throw too_large_error(here(), "faces", limits_.max_faces);
      state_ = State::kFacet;
      take_normal(rest);
    } else if (state_ == State::kFacet && is(word, "outer")) {
      if (!is(next_token(rest), "loop")) throw error("\"outer\" without \"loop\"");
      state_ = State::kLoop;
      corners_ = 0;
    } else if (state_ == State::kLoop && is(word, "vertex")) {
      take_vertex(rest);
    } else if (state_ == State::kLoop && is_end_of("loop", word, rest)) {
      if (corners_ != 3) {
        throw error("a facet with " + std::to_string(corners_) + " vertices; STL has triangles")
            .at_element(positions_.size() / 3);
      }
      state_ = State::kLoopEnded;
      skip_remark(rest, {}, {"facet"});
    } else if (state_ == State::kLoopEnded && is_end_of("facet", word, rest)) {
      positions_.insert(positions_.end(), triangle_, triangle_ + 3);
      state_ = State::kSolid;
      skip_remark(rest, {"facet"}, {"solid"});
    } else if (state_ == State::kSolid && is_end_of("solid", word, rest)) {
      state_ = State::kOutside;
      rest = {};
    } else {
      throw error(expected() + cited(word));
    }
  }

  /// Skips `normal nx ny nz`. It may be any three words, since the normal is not used and programs write various
  /// things for a facet without one.
  static void take_normal(std::string_view& rest) {
    std::string_view ahead = rest;
    if (!is(next_token(ahead), "normal")) return;
    rest = ahead;
    for (int axis = 0; axis < 3; ++axis) {
      ahead = rest;
      if (is(next_token(ahead), "outer")) return;
      rest = ahead;
    }
  }

  void take_vertex(std::string_view& rest) {
    Vec3 position;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = next_token(rest);
      if (token.empty()) throw error("a vertex with fewer than three coordinates");
      position[axis] = parse_coordinate(token, here());
    }
    if (corners_ < 3) triangle_[corners_] = position;
    ++corners_;
  }

  /// Skips the rest of the line, unless it continues with the next part: with one of these keywords, or with the end
  /// of one of these parts.
  static void skip_remark(std::string_view& rest, std::initializer_list<std::string_view> next_keywords,
                          std::initializer_list<std::string_view> next_ends) {
    std::string_view ahead = rest;
    const std::string_view word = next_token(ahead);
    const auto comes = [&](std::string_view keyword) { return is(word, keyword); };
    const auto ends = [&](std::string_view part) {
      std::string_view behind = ahead;
      return is_end_of(part, word, behind);
    };
    if (std::none_of(next_keywords.begin(), next_keywords.end(), comes) &&
        std::none_of(next_ends.begin(), next_ends.end(), ends))
      rest = {};
  }

  /// True if `word` is the keyword that ends a part, as one word (`endloop`) or as two (`end loop`). The second word
  /// is then removed from `rest`.
  static bool is_end_of(std::string_view part, std::string_view word, std::string_view& rest) {
    constexpr std::string_view kEnd = "end";
    if (!is(word.substr(0, kEnd.size()), kEnd)) return false;
    if (word.size() > kEnd.size()) return is(word.substr(kEnd.size()), part);
    std::string_view ahead = rest;
    if (!is(next_token(ahead), part)) return false;
    rest = ahead;
    return true;
  }

  static bool is_comment(std::string_view word) {
    return word.starts_with('#') || word.starts_with(';') || word.starts_with('!') || word.starts_with("//");
  }

  static bool is_keyword(std::string_view word) {
    constexpr std::array<std::string_view, 10> kKeywords{"solid",  "facet", "normal",  "outer",    "loop",
                                                         "vertex", "end",   "endloop", "endfacet", "endsolid"};
    return std::any_of(kKeywords.begin(), kKeywords.end(), [&](std::string_view k) { return is(word, k); });
  }

  void label(PolygonMesh& mesh) const {
    const bool is_named = std::any_of(solids_.begin(), solids_.end(), [](const Solid& s) { return !s.name.empty(); });
    if (solids_.size() == 1 && !is_named) return;
    LabelSet& objects = mesh.labels.object;
    objects.of_face.reserve(mesh.face_count());
    for (std::size_t s = 0; s < solids_.size(); ++s) {
      const std::size_t end = s + 1 < solids_.size() ? solids_[s + 1].first_face : mesh.face_count();
      if (end == solids_[s].first_face) continue;
      const auto index = static_cast<std::uint32_t>(objects.names.size());
      objects.names.push_back(solids_[s].name);
      objects.of_face.resize(end, index);
    }
  }

  std::string expected() const {
    switch (state_) {
      case State::kOutside: return "expected \"solid\", found ";
      case State::kSolid: return "expected \"facet\" or \"endsolid\", found ";
      case State::kFacet: return "expected \"outer loop\", found ";
      case State::kLoop: return "expected \"vertex\" or \"endloop\", found ";
      case State::kLoopEnded: return "expected \"endfacet\", found ";
    }
    return "";
  }

  static bool is(std::string_view word, std::string_view keyword) { return equals_ignoring_case(word, keyword); }
  Place here() const { return Place::line(lines_.number()); }
  Error error(const std::string& message) const { return read_error(here(), Code::kInvalidMesh, message); }

  std::string_view content_;
  TextLines lines_;
  const ReadLimits& limits_;
  RunControl& control_;
  State state_ = State::kOutside;
  std::vector<Solid> solids_;
  std::vector<Vec3> positions_;
  Vec3 triangle_[3];
  std::uint64_t corners_ = 0;
  std::size_t ticks_ = 0;
};

}  // namespace

bool has_length_of_binary_stl(std::string_view content) {
  // A text does not have this length by chance: its bytes at the place of the count would mean at least 150 million
  // triangles.
  if (content.size() < kBeginOfRecords) return false;
  const std::uint64_t count = load<std::uint32_t>(content.data() + kHeader, ByteOrder::kLittle);
  return content.size() == kBeginOfRecords + kRecord * count;
}

bool is_binary_stl(std::string_view content) {
  if (has_length_of_binary_stl(content)) return true;
  // The highest byte of the count is 0 in all files under 800 MB, and the attributes of nearly all triangles are 0.
  // Zeros at the end are ignored, because they may pad a text.
  constexpr std::size_t kProbe = 1024;
  return !wide_encoding(content) && without_padding(content).substr(0, kProbe).find('\0') != std::string_view::npos;
}

ReadResult read_stl(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return is_binary_stl(content) ? read_binary(content, limits, control) : TextReader(content, limits, control).read();
}

}  // namespace remesh
