#include "server/http/header_lists.h"

namespace remesh::server {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> list_elements(std::string_view text) {
  std::vector<std::string_view> elements;
  while (!text.empty()) {
    const std::size_t end = text.find(',');
    if (const std::string_view element = trimmed(text.substr(0, end)); !element.empty()) elements.push_back(element);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return elements;
}

}  // namespace remesh::server
