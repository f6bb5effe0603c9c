#include "core/io/obj_records.h"

#include <algorithm>

#include "core/io/read_errors.h"
#include "core/io/text.h"

namespace remesh {
namespace {

bool is_keyword(std::string_view token) {
  return is_letter(token.front()) && std::all_of(token.begin(), token.end(), is_obj_keyword_character);
}

bool is_comment(std::string_view line) {
  const std::string_view first = next_token(line);
  return first.starts_with('#');
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

/// The line that the walk stands on, with those that continue it. Comments may hold any byte.
std::string_view ObjRecords::take_logical_line() {
  std::string_view line = lines_.line();
  if (is_comment(line)) return line;
  lines_.check_is_text();
  if (!line.ends_with('\\')) return line;

  joined_.clear();
  while (line.ends_with('\\')) {
    joined_.append(line.substr(0, line.size() - 1));
    joined_ += ' ';  // nobody breaks a line inside a number, some break it right after one
    if (!lines_.next()) return joined_;
    lines_.check_is_text();
    line = lines_.line();
  }
  joined_.append(line);
  return joined_;
}

}  // namespace remesh
