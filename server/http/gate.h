/// Reads one request from a connection under deadlines and size limits: first its head, then its body if a route wants
/// it. The code behind the gate never sees a malformed or oversized request. Bytes that the client sent beyond the
/// request stay with the connection.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "server/http/body.h"
#include "server/http/connection.h"
#include "server/http/http_message.h"
#include "server/http/request_head.h"

namespace remesh::server {

struct GateLimits {
  HeadLimits head;
  std::chrono::milliseconds head_timeout{10'000};  ///< time for the whole head; also the grace period of the body
  std::uint64_t min_body_rate = 1024;              ///< bytes a second that a body must reach after the grace period
  /// Grace period of the answer, which must reach min_body_rate afterwards.
  std::chrono::milliseconds write_timeout{60'000};
};

/// Reads the head of a request.
/// Input:   `head` - filled as far as parsing came, so that a refusal can carry the request's id.
/// Output:  how the body is delimited; nothing if the client closed the connection or sent nothing in time.
/// Errors:  HttpError - 400, 408, 411, 414, 431, 501; ConnectionLost.
std::optional<Framing> read_head(Connection& connection, const GateLimits& limits, RequestHead& head);

/// A function that is called while a body is read, before more of it enters memory. `held` is the number of bytes
/// that will be buffered then, and `expected` the size of the whole body as far as it is known. It throws HttpError
/// to refuse the body.
using Reserve = std::function<void(std::uint64_t held, std::uint64_t expected)>;

/// Reads the body that follows a head and removes the chunked coding. A Content-Encoding is left to the caller. If the
/// client waits for 100 Continue, it is sent.
/// Errors:  HttpError - 400, 408, 413 (longer than `max_body`), and whatever `reserve` throws; ConnectionLost.
Body read_body(Connection& connection, const GateLimits& limits, const RequestHead& head, const Framing& framing,
               std::uint64_t max_body, const Reserve& reserve);

}  // namespace remesh::server
