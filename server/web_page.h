/// The web page, which is compiled in: see server/web/README.md.
#pragma once

#include <string_view>
#include <vector>

#include "server/http/route.h"

namespace remesh::server {

struct WebFile {
  std::string_view path;
  std::string_view type;
  std::string_view bytes;
  bool is_packed = false;  ///< `bytes` are gzip data
  bool is_fixed = false;   ///< the path changes with the contents, so that browsers need never ask again
};

/// Made while building, of `server/web/`; with -DREMESHD_WEB=OFF one file that says so. The first one is `/`.
std::vector<WebFile> web_files();

/// A route for each file, open to clients without a key.
/// Holds:   every answer has an `ETag`, for which `If-None-Match` gets 304, and headers that let the page load and ask
///          nothing but this daemon; a client that does not take gzip gets the bytes unpacked.
std::vector<Route> web_routes(const std::vector<WebFile>& files);

}  // namespace remesh::server
