#include "server/http/http_message.h"

namespace remesh::server {

HttpError body_too_large(std::uint64_t limit) {
  const std::string detail = limit == 0 ? std::string("this resource accepts no request body")
                                        : "the body is longer than " + std::to_string(limit) + " bytes";
  return HttpError(413, "body_too_large", detail).with_limit(limit);
}

HttpError never_fits(std::uint64_t limit) {
  return HttpError(413, "mesh_too_large",
                   "this mesh needs more memory than this server may use, which is " + std::to_string(limit) + " bytes")
      .with_limit(limit);
}

HttpError out_of_memory() {
  return HttpError(503, "out_of_memory",
                   "the server has not enough memory for this request at the moment: try "
                   "again shortly");
}

HttpError draining() { return HttpError(503, "draining", "this server is about to stop"); }

}  // namespace remesh::server
