#include "core/io/obj/obj_chunk.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <system_error>
#include <utility>

#include "core/io/common/digits.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/number_parsing.h"
#include "core/io/obj/obj_records.h"

namespace remesh {
namespace {

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

}  // namespace

std::optional<ObjChunk> parse_obj_chunk(std::string_view text) {
  Parser parser(text);
  if (!parser.parse()) return std::nullopt;
  return parser.take();
}

}  // namespace remesh
