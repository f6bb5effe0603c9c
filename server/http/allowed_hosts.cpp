#include "server/http/allowed_hosts.h"

#include <algorithm>
#include <stdexcept>

#include "server/http/header_lists.h"
#include "server/http/host_name.h"

namespace remesh::server {
namespace {

constexpr std::string_view kAnyHost = "*";

bool is_name(std::string_view text) {
  constexpr std::string_view kSigns = "-._";
  return std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || kSigns.find(c) != std::string_view::npos;
  });
}

}  // namespace

AllowedHosts::AllowedHosts(std::string_view names) {
  for (const std::string_view text : list_elements(names)) {
    const Host host = parse_host(text);
    if (text != kAnyHost && (!host.port.empty() || host.name.empty() || !is_name(host.name))) {
      throw std::invalid_argument("\"" + std::string(text) +
                                  "\" is not a DNS name without a port, such as "
                                  "mesh.example.org");
    }
    names_.push_back(host.name);
  }
}

bool AllowedHosts::allows(std::string_view name) const {
  return std::any_of(names_.begin(), names_.end(), [&](const std::string& n) { return n == kAnyHost || n == name; });
}

std::string AllowedHosts::text() const {
  std::string text;
  for (const std::string& name : names_) text += (text.empty() ? "" : ",") + name;
  return text.empty() ? "none" : text;
}

}  // namespace remesh::server
