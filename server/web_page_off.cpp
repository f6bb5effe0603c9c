// Replaces the page if it was left out of the build.
#include "server/web_page.h"

namespace remesh::server {

std::vector<WebFile> web_files() {
  return {{"/", "text/plain; charset=utf-8",
           "remeshd: POST a mesh to /v1/remesh; /openapi.json describes everything.\n"
           "The page that stands here otherwise was left out of this build (REMESHD_WEB=OFF).\n"}};
}

}  // namespace remesh::server
