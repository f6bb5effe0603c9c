#include "server/idle_connections.h"

#include <sys/socket.h>

namespace remesh::server {

IdleConnections::Stay::Stay(IdleConnections& all, int socket)
    : all_(all), number_([&] {
        const std::lock_guard lock(all.mutex_);
        if (all.is_over_) end(socket);
        if (all.sockets_.size() == all.most_) {
          const auto oldest = all.sockets_.begin();
          end(oldest->second);
          all.sockets_.erase(oldest);
        }
        all.sockets_.emplace(all.next_number_, socket);
        ++all.count_;
        return all.next_number_++;
      }()) {}

IdleConnections::Stay::~Stay() {
  // Under the lock: whoever ends a connection does so before its descriptor is closed.
  const std::lock_guard lock(all_.mutex_);
  all_.sockets_.erase(number_);
  --all_.count_;
}

void IdleConnections::end_all() {
  const std::lock_guard lock(mutex_);
  is_over_ = true;
  for (const auto& [number, socket] : sockets_) end(socket);
}

void IdleConnections::end(int socket) { ::shutdown(socket, SHUT_RD); }

}  // namespace remesh::server
