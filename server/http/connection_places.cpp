#include "server/http/connection_places.h"

namespace remesh::server {

ConnectionPlaces::Served::~Served() {
  if (all_ == nullptr) return;
  const std::lock_guard lock(all_->mutex_);
  --all_->served_;
}

std::optional<ConnectionPlaces::Served> ConnectionPlaces::enter() {
  const std::lock_guard lock(mutex_);
  if (served_ >= max_) return std::nullopt;
  ++served_;
  make_room_locked();
  return Served(*this);
}

ConnectionPlaces::Wait::Wait(ConnectionPlaces& all, Event& end) : all_(all), number_(all.add(end)) {}

ConnectionPlaces::Wait::~Wait() {
  // Under the lock, the event of a wait that is being ended still exists.
  const std::lock_guard lock(all_.mutex_);
  all_.ends_.erase(number_);
  --all_.waiting_;
}

std::uint64_t ConnectionPlaces::add(Event& end) {
  const std::lock_guard lock(mutex_);
  end.clear();  // the event may still be set from an earlier wait that a request ended first
  if (is_over_) end.set();
  ends_.emplace(next_number_, &end);
  ++waiting_;
  make_room_locked();
  return next_number_++;
}

void ConnectionPlaces::make_room_locked() {
  while (!ends_.empty() && served_ + ends_.size() > max_) {
    const auto oldest = ends_.begin();
    oldest->second->set();
    ends_.erase(oldest);
  }
}

void ConnectionPlaces::end_all() {
  const std::lock_guard lock(mutex_);
  is_over_ = true;
  for (const auto& [number, end] : ends_) end->set();
}

void ConnectionPlaces::begin_again() {
  const std::lock_guard lock(mutex_);
  is_over_ = false;
}

}  // namespace remesh::server
