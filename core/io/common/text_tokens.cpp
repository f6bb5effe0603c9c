#include "core/io/common/text_tokens.h"

namespace remesh {

bool TextTokens::next_line() {
  if (!lines_.next()) {
    rest_ = {};
    return false;
  }
  rest_ = lines_.line();
  const std::size_t begin = comment_ == 0 ? std::string_view::npos : rest_.find(comment_);
  comment_text_ = begin == std::string_view::npos ? std::string_view() : rest_.substr(begin + 1);
  if (begin == std::string_view::npos) lines_.check_is_text();
  rest_ = rest_.substr(0, begin);
  return true;
}

Error TextTokens::expected(const char* what, std::string_view found) const {
  return read_error(
      place(), Code::kInvalidMesh,
      std::string(what) + " was expected, " + (found.empty() ? "but the text ends" : "found " + cited(found)));
}

}  // namespace remesh
