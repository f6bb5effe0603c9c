#include "api/cli/http_client.h"

#include <httplib.h>

namespace remesh::cli {
namespace {

class Client : public HttpClient {
 public:
  explicit Client(const std::string& server) : http_(server) {
    http_.set_connection_timeout(5);
    http_.set_read_timeout(60);
    http_.set_write_timeout(60);
  }

  bool is_valid() const { return http_.is_valid(); }

  HttpAnswer ask(const HttpRequest& request) override {
    const httplib::Headers headers(request.headers.begin(), request.headers.end());
    httplib::Result result = send(request, headers);
    HttpAnswer answer;
    if (!result) {
      answer.failure = httplib::to_string(result.error());
      return answer;
    }
    answer.status = result->status;
    answer.body = std::move(result->body);
    answer.summary = result->get_header_value("Remesh-Summary");
    return answer;
  }

 private:
  httplib::Result send(const HttpRequest& request, const httplib::Headers& headers) {
    if (request.method == "POST")
      return http_.Post(request.target, headers, request.body.data(), request.body.size(), request.content_type);
    if (request.method == "DELETE") return http_.Delete(request.target, headers);
    return http_.Get(request.target, headers);
  }

  httplib::Client http_;
};

}  // namespace

HttpClient* remesh_new_http_client(const char* server) {
  auto client = std::make_unique<Client>(server);
  return client->is_valid() ? client.release() : nullptr;
}

}  // namespace remesh::cli
