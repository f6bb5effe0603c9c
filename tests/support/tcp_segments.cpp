#include "tests/support/tcp_segments.h"

#include <linux/tcp.h>  // the C library's own header has fewer members
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <system_error>

namespace remesh {

std::uint32_t data_segments_received(int socket) {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0)
    throw std::system_error(errno, std::generic_category(), "TCP_INFO");
  return info.tcpi_data_segs_in;
}

}  // namespace remesh
