#include "server/http/http_message.h"

namespace remesh::server {

HttpError never_fits(std::uint64_t limit) {
  return HttpError(413, "mesh_too_large", "the work on this mesh takes more memory than this server may use")
      .with_limit(limit);
}

HttpError out_of_memory() {
  return HttpError(503, "out_of_memory", "not enough memory for this request now: try again shortly");
}

}  // namespace remesh::server
