/// Tells how a client received its answer.
#pragma once

#include <cstdint>

namespace remesh {

/// Returns how many segments with data have arrived at a TCP socket.
/// Errors: std::system_error - it is not a TCP socket.
std::uint32_t data_segments_received(int socket);

}  // namespace remesh
