/// What a client can know of how its answer came.
#pragma once

#include <cstdint>

namespace remesh {

/// How many segments with data have arrived at a TCP socket. Errors: std::system_error - it is none.
std::uint32_t data_segments_received(int socket);

}  // namespace remesh
