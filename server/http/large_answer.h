/// Sends answers that are too large to stay in memory while a slow client reads them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "server/http/connection.h"
#include "server/http/spool.h"

namespace remesh::server {

/// Answers with more bytes than this are sent by send_large.
inline constexpr std::size_t kLargeAnswer = 1 << 20;

/// Sends the body of an answer. If the client does not keep up, the rest goes to the spool, and its memory is freed.
/// Then the client must reach 64 KiB a second after a minute, and read everything within half an hour.
/// Input:  `release_memory` - called when the body no longer takes memory.
/// Errors: ConnectionLost - the client is gone, too slow, or the slowest of all clients when there is no room.
void send_large(Connection& connection, std::string body, Spool& spool, const std::function<void()>& release_memory);

}  // namespace remesh::server
