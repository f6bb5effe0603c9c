#include "core/io/common/read_errors.h"

#include "core/io/common/number_parsing.h"

namespace remesh {
namespace {

Diagnostic trailing_bytes(std::size_t count, const std::string& where) {
  return {DiagnosticCode::kTrailingBytes, count, {}, "bytes" + where + ", were ignored: " + std::to_string(count)};
}

std::string behind_the_records(std::size_t end_of_records) {
  return " after the last record, from byte " + std::to_string(end_of_records) + " on";
}

}  // namespace

std::string cited(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string quoted = "\"";
  for (const char c : text.substr(0, kLongest)) quoted += is_control_character(c) ? '?' : c;
  return quoted + (text.size() > kLongest ? "...\"" : "\"");
}

void record_dropped(const std::string& what, std::uint64_t count, std::vector<Diagnostic>& diagnostics) {
  if (count > 0)
    diagnostics.push_back({DiagnosticCode::kAttributeDropped, count, {}, what + ": " + std::to_string(count)});
}

void record_trailing_bytes(std::string_view content, std::size_t end_of_records, std::size_t record_size,
                           std::vector<Diagnostic>& diagnostics) {
  const std::string_view rest = content.substr(end_of_records);
  if (rest.empty()) return;
  const std::string where = behind_the_records(end_of_records);
  if (rest.size() >= record_size && rest.find_first_not_of('\0') != std::string_view::npos) {
    throw read_error(
        Place::byte(end_of_records), Code::kInvalidMesh,
        std::to_string(rest.size()) + " bytes" + where + "; does the file have more records than it announces?");
  }
  diagnostics.push_back(trailing_bytes(rest.size(), where));
}

void record_padding(std::string_view text, std::vector<Diagnostic>& diagnostics) {
  const std::size_t end = without_padding(text).size();
  if (end < text.size()) diagnostics.push_back(trailing_bytes(text.size() - end, behind_the_records(end)));
}

}  // namespace remesh
