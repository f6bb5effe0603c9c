#include "server/http/idle_connections.h"

namespace remesh::server {

IdleConnections::Stay::Stay(IdleConnections& all, Event& end) : all_(all), number_(all.add(end)) {}

IdleConnections::Stay::~Stay() {
  // The lock makes sure that whoever ends a stay does so while its event exists.
  const std::lock_guard lock(all_.mutex_);
  all_.ends_.erase(number_);
  --all_.count_;
}

std::uint64_t IdleConnections::add(Event& end) {
  const std::lock_guard lock(mutex_);
  end.clear();  // it may still be set from an earlier stay that a request ended first
  if (is_over_) end.set();
  if (ends_.size() == most_) {
    const auto oldest = ends_.begin();
    oldest->second->set();
    ends_.erase(oldest);
  }
  ends_.emplace(next_number_, &end);
  ++count_;
  return next_number_++;
}

void IdleConnections::end_all() {
  const std::lock_guard lock(mutex_);
  is_over_ = true;
  for (const auto& [number, end] : ends_) end->set();
}

void IdleConnections::begin_again() {
  const std::lock_guard lock(mutex_);
  is_over_ = false;
}

}  // namespace remesh::server
