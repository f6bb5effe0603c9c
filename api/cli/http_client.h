/// The HTTP client of `--server`. It is a library of its own that is loaded only when a server is asked. It needs
/// OpenSSL, which takes longer to start than a small mesh takes to remesh.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace remesh::cli {

struct HttpRequest {
  std::string method;  ///< GET, POST or DELETE
  std::string target;  ///< the path with its query
  std::vector<std::pair<std::string, std::string>> headers;
  std::string_view body;     ///< the body of a POST
  std::string content_type;  ///< the type of that body
};

struct HttpAnswer {
  int status = 0;       ///< 0 if there was no answer
  std::string failure;  ///< why there was no answer
  std::string body;
  std::string summary;  ///< the header Remesh-Summary; empty if there is none
};

/// A connection to one server. It must not be used by several threads at once.
class HttpClient {
 public:
  virtual ~HttpClient() = default;
  virtual HttpAnswer ask(const HttpRequest& request) = 0;
};

/// The one function of the library. Returns nothing if `server` is not a URL that it knows.
extern "C" HttpClient* remesh_new_http_client(const char* server);
using NewHttpClient = decltype(remesh_new_http_client);

}  // namespace remesh::cli
