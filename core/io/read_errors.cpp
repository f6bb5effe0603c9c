#include "core/io/read_errors.h"

#include "core/io/text.h"

namespace remesh {

std::string cited(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string quoted = "\"";
  for (const char c : text.substr(0, kLongest)) quoted += is_control_character(c) ? '?' : c;
  return quoted + (text.size() > kLongest ? "...\"" : "\"");
}

void note_trailing_bytes(std::string_view content, std::size_t end_of_records, std::size_t record_size,
                         std::vector<Diagnostic>& diagnostics) {
  const std::string_view rest = content.substr(end_of_records);
  if (rest.empty()) return;
  const std::string where = " after the last record, from byte " + std::to_string(end_of_records) + " on";
  if (rest.size() >= record_size && rest.find_first_not_of('\0') != std::string_view::npos) {
    throw read_error(Place::byte(end_of_records), Code::kInvalidMesh,
                     std::to_string(rest.size()) + " bytes" + where + ": more records than the file counts?");
  }
  diagnostics.push_back({DiagnosticCode::kTrailingBytes,
                         rest.size(),
                         {},
                         "bytes" + where + ", left out: " + std::to_string(rest.size())});
}

}  // namespace remesh
