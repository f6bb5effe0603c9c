/// Reads one request from a connection under deadlines and caps; nothing behind it ever sees a malformed or oversized
/// one.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "server/connection.h"
#include "server/http_message.h"
#include "server/request_head.h"

namespace remesh::server {

struct GateLimits {
  HeadLimits head;
  std::chrono::milliseconds head_timeout{10'000};   ///< for the whole head; also the grace of the body
  std::uint64_t min_body_rate = 1024;               ///< bytes a second, after the grace
  std::chrono::milliseconds write_timeout{60'000};  ///< grace of the answer, which then obeys min_body_rate too
};

/// Told of a head before its body is read: how many bytes of body this request may have. Throws HttpError to refuse it.
using Admit = std::function<std::uint64_t(const RequestHead&)>;
/// Names a request, as soon as its head is known or has failed (then the head is empty).
using NameRequest = std::function<std::string(const RequestHead&)>;

/// Reads head and body. Says 100 Continue where the client waits for it, and only once the head has been admitted.
/// Input:   `request` is filled as far as reading came, so that a refusal can carry its id.
/// Output:  false - the client left without a request.
/// Errors:  HttpError - 400, 408, 411, 413, 414, 415, 431, 501, and what `admit` throws; ConnectionLost.
bool read_request(Connection& connection, const GateLimits& limits, const NameRequest& name, const Admit& admit,
                  Request& request);

}  // namespace remesh::server
