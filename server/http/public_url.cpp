#include "server/http/public_url.h"

#include <algorithm>
#include <stdexcept>

namespace remesh::server {

bool is_path_prefix(std::string_view text) {
  constexpr std::string_view kSigns = "-._~/";
  const bool is_plain = std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           kSigns.find(c) != std::string_view::npos;
  });
  return is_plain && text.size() > 1 && text.starts_with('/') && !text.ends_with('/') &&
         text.find("//") == std::string_view::npos && text.find("/.") == std::string_view::npos;
}

PublicUrl::PublicUrl(std::string_view text) {
  const auto reject = [&] {
    throw std::invalid_argument("\"" + std::string(text) + "\" is not a URL such as https://mesh.example.org/prefix");
  };
  std::string_view rest = text;
  while (rest.ends_with('/')) rest.remove_suffix(1);
  const std::size_t scheme_end = rest.find("://");
  if (scheme_end == std::string_view::npos) reject();
  const std::size_t path = std::min(rest.find('/', scheme_end + 3), rest.size());
  origin_ = parse_origin(rest.substr(0, path));
  if (!origin_ || (origin_->scheme != "http" && origin_->scheme != "https") || origin_->host.name.empty()) reject();
  prefix_ = rest.substr(path);
  if (!prefix_.empty() && !is_path_prefix(prefix_)) reject();
  text_ = rest;
}

}  // namespace remesh::server
