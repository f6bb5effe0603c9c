/// The web page, which is compiled into the daemon. See server/web/README.md.
#pragma once

#include <string_view>
#include <vector>

#include "server/http/route.h"

namespace remesh::server {

struct WebFile {
  std::string_view path;
  std::string_view type;
  std::string_view bytes;
  bool is_packed = false;  ///< `bytes` are in gzip's format
  bool is_fixed = false;   ///< the path changes with the contents, so browsers may store the file for ever
};

/// The files of the page, generated from `server/web/` by the build. With -DREMESHD_WEB=OFF there is a single file,
/// whose text says that the page is missing. The first file is `/`.
std::vector<WebFile> web_files();

/// Makes a route for each file. The routes are public: clients need no key.
/// Holds:   every answer has an `ETag`, and a matching `If-None-Match` gets 304; the headers let the page load from
///          and connect to this daemon only; a client that does not accept gzip gets the unpacked bytes.
std::vector<Route> web_routes(const std::vector<WebFile>& files);

}  // namespace remesh::server
