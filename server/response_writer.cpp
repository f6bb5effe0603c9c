#include "server/response_writer.h"

#include <array>
#include <ctime>

namespace remesh::server {
namespace {

void add_field(std::string& head, std::string_view name, std::string_view value) {
  head.append(name).append(": ");
  for (const char c : value) head += (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) ? ' ' : c;
  head += "\r\n";
}

std::string http_date() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &utc);  // the C locale: nothing sets another
  return text.data();
}

}  // namespace

std::string response_head(const Request& request, const Response& response) {
  std::string head =
      "HTTP/1.1 " + std::to_string(response.status) + " " + std::string(api::status_title(response.status)) + "\r\n";
  add_field(head, "Date", http_date());
  add_field(head, "Connection", "close");
  add_field(head, "X-Request-Id", request.id);
  add_field(head, "X-Content-Type-Options", "nosniff");
  if (!response.content_type.empty()) add_field(head, "Content-Type", response.content_type);
  if (!response.stream && response.status != 204)
    add_field(head, "Content-Length", std::to_string(response.body.size()));
  for (const auto& [name, value] : response.headers) add_field(head, name, value);
  return head + "\r\n";
}

void send_response(Connection& connection, const Request& request, const Response& response) {
  connection.write_all(response_head(request, response));
  if (request.method == "HEAD" || response.status == 204) return;
  if (response.stream) {
    response.stream(connection);
  } else {
    connection.write_all(response.body);
  }
}

}  // namespace remesh::server
