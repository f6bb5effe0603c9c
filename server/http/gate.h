/// Reads one request from a connection under deadlines and caps, first its head, then, for whoever wants it, its body;
/// nothing behind it ever sees a malformed or oversized one. What the client sent beyond it stays with the connection.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/http/body.h"
#include "server/http/connection.h"
#include "server/http/http_message.h"
#include "server/http/request_head.h"

namespace remesh::server {

struct GateLimits {
  HeadLimits head;
  std::chrono::milliseconds head_timeout{10'000};   ///< for the whole head; also the grace of the body
  std::uint64_t min_body_rate = 1024;               ///< bytes a second, after the grace
  std::chrono::milliseconds write_timeout{60'000};  ///< grace of the answer, which then obeys min_body_rate too
};

/// Reads a head.
/// Input:   `head` is filled as far as reading came, so that a refusal can carry the request's id.
/// Output:  how its body is delimited; nothing - the client left, or stayed, without a word.
/// Errors:  HttpError - 400, 408, 411, 414, 431, 501; ConnectionLost.
std::optional<Framing> read_head(Connection& connection, const GateLimits& limits, RequestHead& head);

/// Asked while a body is read: `held` bytes of it are about to be in memory, and `expected` ones are to come in all, as
/// far as that is known. Throws HttpError to refuse.
using Reserve = std::function<void(std::uint64_t held, std::uint64_t expected)>;

/// Reads the body behind a head, out of its chunks; what Content-Encoding says is left to whoever takes it. Says 100
/// Continue where the client waits for it.
/// Errors:  HttpError - 400, 408, 413 (longer than `max_body`), what `reserve` throws; ConnectionLost.
Body read_body(Connection& connection, const GateLimits& limits, const RequestHead& head, const Framing& framing,
               std::uint64_t max_body, const Reserve& reserve);

}  // namespace remesh::server
