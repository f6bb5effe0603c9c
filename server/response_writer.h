/// Answers on their way out.
#pragma once

#include <string>

#include "server/connection.h"
#include "server/http_message.h"

namespace remesh::server {

/// The head of an answer. Values cannot break out of their line: control characters become blanks.
std::string response_head(const Request& request, const Response& response);

/// Sends head and body; a HEAD request gets the head alone. Errors: ConnectionLost.
void send_response(Connection& connection, const Request& request, const Response& response);

}  // namespace remesh::server
