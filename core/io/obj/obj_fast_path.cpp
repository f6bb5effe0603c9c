#include <fast_float/fast_float.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/io/common/digits.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/text_lines.h"
#include "core/io/obj/obj_dropped_records.h"
#include "core/io/obj/obj_readers.h"
#include "core/io/obj/obj_records.h"

namespace remesh {
namespace {

/// The content of the lines of a chunk, as far as it is known without the text before them.
struct ObjChunk {
  enum class LabelKind : std::uint8_t { kObject, kGroup, kMaterial };
  /// A record that labels all following faces. `face` is the number of the first such face within the chunk. The name
  /// is a view into the text, unchanged.
  struct Label {
    LabelKind kind;
    std::uint32_t face;
    std::string_view name;
  };

  std::vector<Vec3> positions;
  /// Vertex numbers from 0. Those at the positions in `relative` are 32-bit differences to the number of vertices
  /// before the chunk.
  std::vector<VertexId> corners;
  std::vector<std::uint32_t> relative;
  std::vector<std::uint32_t> face_end;  ///< the ends of the faces in `corners`
  std::uint32_t largest_index = 0;      ///< largest index that is not relative, from 1; 0 if there is none
  std::vector<Label> labels;
  std::vector<std::string_view> material_libraries;
  ObjExtras extras;
};

/// True if the character ends a token: a blank or a line end. Nearly all other characters are above them.
bool is_token_end(char c) { return static_cast<unsigned char>(c) <= ' ' && (is_blank(c) || is_line_end(c)); }

/// Parses a chunk. Every `take_` function returns false if the text does not fit, which ends the parsing. The text ends
/// with a line end, so no step must check for the end of the text.
class Parser {
 public:
  explicit Parser(std::string_view text) : at_(text.data()), end_(at_ + text.size()) { reserve(text); }

  bool parse() {
    while (at_ != end_) {
      skip_blanks();
      if (*at_ == 'v' && is_blank(at_[1])) {
        ++at_;
        if (!take_vertex()) return false;
      } else if (*at_ == 'f' && is_blank(at_[1])) {
        ++at_;
        if (!take_face()) return false;
      } else if (*at_ == '#') {
        skip_comment();
      } else if (!is_line_end(*at_) && !take_other_record()) {
        return false;
      }
      ++at_;  // skips the line end
    }
    return true;
  }

  ObjChunk take() { return std::move(chunk_); }

 private:
  /// Reserves memory for a chunk that consists only of records like its first one, with a usual length. Growing a list
  /// step by step takes longer. A chunk with one very long line does not have more records.
  void reserve(std::string_view text) {
    constexpr std::size_t kVertexLine = 24, kFaceLine = 16, kUsualChunk = std::size_t{1} << 18;
    const std::size_t size = std::min(text.size(), kUsualChunk);
    if (text.starts_with("v ")) {
      chunk_.positions.reserve(size / kVertexLine);
    } else if (text.starts_with("f ")) {
      chunk_.face_end.reserve(size / kFaceLine);
      chunk_.corners.reserve(3 * (size / kFaceLine));
    }
  }

  bool take_vertex() {
    double position[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; ++axis) {
      skip_blanks();
      if (has_value()) {
        if (!take_coordinate(position[axis])) return false;
      } else if (axis == 2) {
        chunk_.extras.missing_z.add(chunk_.positions.size());
      } else {
        return false;
      }
    }
    skip_blanks();
    if (has_value()) chunk_.extras.extra_values.add(chunk_.positions.size());
    chunk_.positions.push_back({position[0], position[1], position[2]});
    return end_record();
  }

  bool take_coordinate(double& value) {
    // This works like std::from_chars, but faster. A token without a finite value is handled below.
    const auto [stop, status] = fast_float::from_chars(at_, end_, value);
    if (status == std::errc{} && is_token_end(*stop) && std::isfinite(value)) {
      at_ = stop;
      return true;
    }
    const char* const begin = at_;
    while (!is_token_end(*at_)) ++at_;
    const Real real = parse_real({begin, static_cast<std::size_t>(at_ - begin)});
    value = real.value;
    return real.fault == RealFault::kNone;
  }

  bool take_face() {
    const std::size_t first = chunk_.corners.size();
    for (skip_blanks(); has_value(); skip_blanks()) {
      // One line may be as long as the file, so no more of it is read than a face may have.
      if (!take_corner() || chunk_.corners.size() - first > kMaxObjFaceCorners) return false;
    }
    if (chunk_.corners.size() - first < 3) return false;
    chunk_.face_end.push_back(static_cast<std::uint32_t>(chunk_.corners.size()));
    return end_record();
  }

  /// Reads a corner: `i`, `i/j`, `i//k` or `i/j/k`, where the numbers after a slash may be missing.
  bool take_corner() {
    std::int32_t index = 0, unused = 0;
    if (!take_integer(index) || index == 0) return false;
    for (int part = 0; part < 2 && *at_ == '/'; ++part) {
      ++at_;
      if (!is_token_end(*at_) && *at_ != '/' && !take_integer(unused)) return false;
    }
    if (!is_token_end(*at_)) return false;
    if (index > 0) {
      chunk_.largest_index = std::max(chunk_.largest_index, static_cast<std::uint32_t>(index));
      chunk_.corners.emplace_back(static_cast<std::uint32_t>(index - 1));
    } else {
      const std::int64_t difference = index + static_cast<std::int64_t>(chunk_.positions.size());
      chunk_.relative.push_back(static_cast<std::uint32_t>(chunk_.corners.size()));
      chunk_.corners.emplace_back(static_cast<std::uint32_t>(static_cast<std::int32_t>(difference)));
    }
    return true;
  }

  /// Reads a number of at most eight digits, which suffices for vertices. A longer number makes the chunk unusual.
  bool take_integer(std::int32_t& value) {
    const char* at = at_;
    const bool is_negative = *at == '-';
    at += is_negative;
    std::int32_t magnitude = 0;
    const int digits = read_digits(at, end_, magnitude);
    value = is_negative ? -magnitude : magnitude;
    at_ = at + digits;
    return digits > 0 && !is_digit(*at_);
  }

  bool take_other_record() {
    const char* const begin = at_;
    if (!is_letter(*at_)) return false;
    while (is_obj_keyword_character(*at_)) ++at_;
    if (!is_token_end(*at_)) return false;
    const std::string_view keyword(begin, static_cast<std::size_t>(at_ - begin));
    const char* const arguments = at_;
    if (!skip_rest_of_line()) return false;
    const std::string_view value = trim({arguments, static_cast<std::size_t>(at_ - arguments)});
    if (keyword == "v" || keyword == "f" || keyword == "fo") return false;
    if (keyword == "o") return take_label(ObjChunk::LabelKind::kObject, value);
    if (keyword == "g") return take_label(ObjChunk::LabelKind::kGroup, value);
    if (keyword == "usemtl") return take_label(ObjChunk::LabelKind::kMaterial, value);
    if (keyword == "mtllib") {
      if (!value.empty()) chunk_.material_libraries.push_back(value);
      return true;
    }
    chunk_.extras.dropped.count(keyword);
    return chunk_.extras.dropped.kinds().size() < DroppedRecords::kMaxKinds;
  }

  bool take_label(ObjChunk::LabelKind kind, std::string_view name) {
    chunk_.labels.push_back({kind, static_cast<std::uint32_t>(chunk_.face_end.size()), name});
    return name.size() <= kMaxNameLength;
  }

  /// True if a value begins here, and not the line's end or a comment.
  bool has_value() const { return !is_line_end(*at_) && *at_ != '#'; }

  /// Goes to the line end of a record whose values have been read.
  bool end_record() { return is_line_end(*at_) || skip_rest_of_line(); }

  /// Fails on a character that may not occur in text, and if the next line continues this one or may do so.
  bool skip_rest_of_line() {
    const char* at = at_;
    while (!is_control_character(*at)) ++at;
    at_ = at;
    const char* last = at - 1;
    while (is_blank(*last)) --last;  // there is a keyword before it
    return is_line_end(*at) && *last != '\\';
  }

  void skip_comment() {
    const char* at = at_;
    while (!is_line_end(*at)) ++at;
    at_ = at;
  }

  void skip_blanks() {
    while (is_blank(*at_)) ++at_;
  }

  const char* at_;
  const char* const end_;
  ObjChunk chunk_;
};

/// Parses whole lines of plain records.
/// Input:  text whose last character is a line end. The character before its first one must be a line end too. The
///         text must outlive the chunk.
/// Output: nothing if some line is continued, may be continued, or is wrong. It is not checked here that the vertices
///         of faces exist.
/// Cost:   O(text); each byte is read once.
std::optional<ObjChunk> parse_obj_chunk(std::string_view text) {
  Parser parser(text);
  if (!parser.parse()) return std::nullopt;
  return parser.take();
}

/// Size of the text that is parsed at once. The parsed chunk stays in a core's cache until it is gathered.
constexpr std::size_t kChunkSize = std::size_t{1} << 18;

/// Splits text into chunks of whole lines. A chunk has the size above, or one long line more.
class Chunks {
 public:
  explicit Chunks(std::string_view text) {
    const std::size_t last_line = text.find_last_of("\n\r") + 1;
    if (last_line < text.size()) last_line_.append(text.substr(last_line)) += '\n';
    text = text.substr(0, last_line);
    while (!text.empty()) {
      std::size_t size = std::min(kChunkSize, text.size());
      while (!is_line_end(text[size - 1])) ++size;
      chunks_.push_back(text.substr(0, size));
      text.remove_prefix(size);
    }
    if (!last_line_.empty()) chunks_.push_back(last_line_);
  }
  Chunks(const Chunks&) = delete;
  Chunks& operator=(const Chunks&) = delete;

  std::size_t size() const { return chunks_.size(); }
  std::string_view operator[](std::size_t i) const { return chunks_[i]; }

 private:
  std::string last_line_;  ///< a copy of the last line if that has no line end
  std::vector<std::string_view> chunks_;
};

/// Joins the names of a `g` record into one.
std::string joined_names(std::string_view names) {
  std::string joined;
  bool is_between = false;
  for (const char c : names) {
    const bool is_gap = c == ' ' || c == '\t';
    if (!is_gap && is_between) joined += ' ';
    if (!is_gap) joined += c;
    is_between = is_gap;
  }
  return joined;
}

/// Appends the chunks to the mesh one after another.
class Gatherer {
 public:
  Gatherer(std::size_t chunks, const ReadLimits& limits) : chunks_left_(chunks), limits_(limits) {}

  /// Input:  `size` - the length of the chunk's text.
  /// Output: false if the chunk does not fit those before it, or exceeds a limit.
  bool add(ObjChunk chunk, std::size_t size) {
    const double share = share_of_faces(chunk, size);
    reserve(mesh_.positions.items(), chunk.positions.size(), 1, limits_.max_vertices);
    reserve(mesh_.corners, chunk.corners.size(), share, PolygonMesh::kMaxCorners);
    reserve(mesh_.face_begin, chunk.face_end.size(), share, limits_.max_faces);
    --chunks_left_;
    if (!resolve(chunk)) return false;
    add_labels(chunk);
    note(chunk.extras);
    const auto corners_before = static_cast<std::uint32_t>(mesh_.corners.size());
    mesh_.face_begin.resize(mesh_.face_begin.size() + chunk.face_end.size());
    std::transform(chunk.face_end.begin(), chunk.face_end.end(), mesh_.face_begin.end() - chunk.face_end.size(),
                   [&](std::uint32_t end) { return corners_before + end; });
    mesh_.corners.insert(mesh_.corners.end(), chunk.corners.begin(), chunk.corners.end());
    mesh_.positions.items().insert(mesh_.positions.end(), chunk.positions.begin(), chunk.positions.end());
    largest_index_ = std::max(largest_index_, chunk.largest_index);
    return mesh_.vertex_count() <= limits_.max_vertices && mesh_.face_count() <= limits_.max_faces &&
           extras_.dropped.kinds().size() < DroppedRecords::kMaxKinds;
  }

  /// Output: nothing if a face has a vertex that the text does not have, or if there is no face.
  std::optional<ReadResult> finish() {
    if (largest_index_ > mesh_.vertex_count() || mesh_.face_count() == 0) return std::nullopt;
    mesh_.labels.object = labels_[static_cast<std::size_t>(ObjChunk::LabelKind::kObject)].take();
    mesh_.labels.group = labels_[static_cast<std::size_t>(ObjChunk::LabelKind::kGroup)].take();
    mesh_.labels.material = labels_[static_cast<std::size_t>(ObjChunk::LabelKind::kMaterial)].take();
    return ReadResult{std::move(mesh_), std::move(extras_).diagnostics()};
  }

 private:
  /// Estimates the share of a chunk's text that its faces take. Faces take a part of the chunk in which the vertices
  /// end, and all of the chunks after it.
  double share_of_faces(const ObjChunk& chunk, std::size_t size) {
    constexpr double kLeast = 1.0 / 64;
    if (chunk.face_end.empty() && !chunk.positions.empty())
      bytes_per_vertex_ = static_cast<double>(size) / static_cast<double>(chunk.positions.size());
    const double of_vertices = bytes_per_vertex_ * static_cast<double>(chunk.positions.size());
    return std::clamp(1 - of_vertices / static_cast<double>(size), kLeast, 1.0);
  }

  /// Reserves room for the items to add. If the memory does not suffice, it also reserves as much for each of the
  /// remaining chunks, assuming that `share` of the text gives that many items. Memory that is not written to costs
  /// nothing, but moving the items would.
  template <class T>
  void reserve(std::vector<T>& items, std::size_t added, double share, std::uint64_t most) const {
    if (items.size() + added <= items.capacity()) return;
    constexpr std::uint64_t kMaxInChunk = kChunkSize / 4;
    const std::uint64_t per_chunk = std::clamp(static_cast<std::uint64_t>(static_cast<double>(added) / share),
                                               std::uint64_t{added}, std::max(std::uint64_t{added}, kMaxInChunk));
    const std::uint64_t wanted = items.size() + per_chunk * chunks_left_ + per_chunk / 8;
    const std::uint64_t least = items.size() + added;
    items.reserve(static_cast<std::size_t>(std::max(least, std::min(wanted, most))));
  }

  /// Converts relative indices to absolute ones.
  bool resolve(ObjChunk& chunk) const {
    if (chunk.corners.size() > PolygonMesh::kMaxCorners - mesh_.corners.size()) return false;
    for (const std::uint32_t corner : chunk.relative) {
      VertexId& vertex = chunk.corners[corner];
      const std::int64_t index =
          static_cast<std::int64_t>(mesh_.vertex_count()) + static_cast<std::int32_t>(vertex.value);
      if (index < 0) return false;
      vertex = VertexId(static_cast<std::uint32_t>(index));
    }
    return true;
  }

  void add_labels(const ObjChunk& chunk) {
    std::size_t face = 0;
    for (const ObjChunk::Label& label : chunk.labels) {
      add_faces(label.face - face);
      face = label.face;
      labels_[static_cast<std::size_t>(label.kind)].name(
          label.kind == ObjChunk::LabelKind::kGroup ? joined_names(label.name) : std::string(label.name));
    }
    add_faces(chunk.face_end.size() - face);
    for (const std::string_view files : chunk.material_libraries) mesh_.labels.material_libraries.emplace_back(files);
  }

  void add_faces(std::size_t count) {
    for (LabelCollector& labels : labels_) labels.add_faces(faces_labelled_, count);
    faces_labelled_ += count;
  }

  void note(const ObjExtras& found) {
    for (const auto& [keyword, count] : found.dropped.kinds()) extras_.dropped.count(keyword, count);
    note(found.extra_values, extras_.extra_values);
    note(found.missing_z, extras_.missing_z);
  }

  void note(const Diagnostic& found, Diagnostic& all) const {
    all.count += found.count;
    for (const std::uint64_t vertex : found.elements) {
      if (all.elements.size() < Diagnostic::kMaxElements) all.elements.push_back(mesh_.vertex_count() + vertex);
    }
  }

  std::size_t chunks_left_;
  double bytes_per_vertex_ = 0;  ///< measured in the last chunk that had only vertices
  const ReadLimits& limits_;
  PolygonMesh mesh_;
  std::array<LabelCollector, 3> labels_;
  std::size_t faces_labelled_ = 0;
  std::uint32_t largest_index_ = 0;
  ObjExtras extras_;
};

}  // namespace

std::optional<ReadResult> read_obj_fast_path(std::string_view text, const ReadLimits& limits, RunControl& control) {
  if (wide_encoding(text)) return std::nullopt;
  if (text.starts_with(kUtf8Mark)) text.remove_prefix(kUtf8Mark.size());
  const Chunks chunks(without_padding(text));
  Gatherer gatherer(chunks.size(), limits);
  const bool is_plain = map_in_order<std::optional<ObjChunk>>(
      chunks.size(), control, [&](std::size_t i) { return parse_obj_chunk(chunks[i]); },
      [&](std::size_t i, std::optional<ObjChunk> chunk) {
        control.progress(static_cast<double>(i + 1) / static_cast<double>(chunks.size()));
        return chunk && gatherer.add(std::move(*chunk), chunks[i].size());
      });
  return is_plain ? gatherer.finish() : std::nullopt;
}

}  // namespace remesh
