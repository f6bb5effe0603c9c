#include "core/io/obj/obj_records.h"

#include <algorithm>
#include <array>

#include "core/io/common/read_errors.h"

namespace remesh {
namespace {

bool is_keyword(std::string_view token) {
  return is_letter(token.front()) && std::all_of(token.begin(), token.end(), is_obj_keyword_character);
}

bool is_comment(std::string_view line) {
  const std::string_view first = next_token(line);
  return first.starts_with('#');
}

/// True if a record consists of numbers only. In all other records a `\` before blanks may be the end of a name.
bool has_only_numbers(std::string_view line) {
  const std::string_view keyword = next_token(line);
  constexpr std::array<std::string_view, 8> kNumeric{"v", "vt", "vn", "vp", "f", "fo", "l", "p"};
  return std::find(kNumeric.begin(), kNumeric.end(), keyword) != kNumeric.end() &&
         line.find('#') == std::string_view::npos;
}

/// Removes the `\` that continues the line, and the blanks after it if these are permitted.
/// Output: false if there is none.
bool cut_continuation(std::string_view& line, bool may_blanks_follow) {
  std::string_view cut = line;
  while (may_blanks_follow && !cut.empty() && is_blank(cut.back())) cut.remove_suffix(1);
  if (!cut.ends_with('\\')) return false;
  cut.remove_suffix(1);
  line = cut;
  return true;
}

Error invalid(std::uint64_t line, const std::string& message) {
  return read_error(Place::line(line), Code::kInvalidMesh, message);
}

}  // namespace

ObjRecords::ObjRecords(std::string_view text) : lines_(text) {}

bool ObjRecords::next() {
  while (lines_.next()) {
    line_ = lines_.number();
    std::string_view rest = take_logical_line();
    const std::string_view first = next_token(rest);
    if (first.empty() || first.starts_with('#')) continue;
    if (!is_keyword(first)) throw invalid(line_, "not an OBJ record: the line does not start with a keyword");
    keyword_ = first;
    arguments_ = rest;
    return true;
  }
  return false;
}

/// Returns the current line with all lines that continue it. Comments may contain any byte.
std::string_view ObjRecords::take_logical_line() {
  std::string_view line = lines_.line();
  if (is_comment(line)) return line;
  lines_.check_is_text();
  if (line.find('\\') == std::string_view::npos) return line;
  const bool may_blanks_follow = has_only_numbers(line);
  if (!cut_continuation(line, may_blanks_follow)) return line;

  joined_.clear();
  do {
    joined_.append(line);
    joined_ += ' ';  // no writer breaks a line inside a number, but some break it directly after one
    if (!lines_.next()) return joined_;
    lines_.check_is_text();
    line = lines_.line();
  } while (cut_continuation(line, may_blanks_follow && line.find('#') == std::string_view::npos));
  joined_.append(line);
  return joined_;
}

}  // namespace remesh
