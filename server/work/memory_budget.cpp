#include "server/work/memory_budget.h"

#include <algorithm>

namespace remesh::server {

std::uint64_t MemoryBudget::used_by_others(std::uint64_t reserved, std::uint64_t own) const {
  if (reserved <= own) return 0;
  return std::max<std::uint64_t>(reserved, used_) - own;
}

std::uint64_t MemoryBudget::available() const { return limit_ - std::min(limit_, used_by_others(reserved_, 0)); }

void MemoryShare::hold_body(std::uint64_t held, std::uint64_t expected) {
  const std::uint64_t limit = budget_.limit_;
  const std::uint64_t body = std::max(held, expected);
  if (body > limit) throw never_fits(limit);
  const std::uint64_t max_with_work = std::max(body, budget_.usual_limit());
  const auto with_work = [&](std::uint64_t bytes) {
    return bytes > max_with_work / per_byte_ ? max_with_work : bytes * per_byte_;
  };
  if (!try_reserve(std::max(bytes_, with_work(held)), std::max(bytes_, with_work(body)))) throw out_of_memory();
}

std::uint64_t MemoryShare::next_reservation(std::uint64_t wanted) const {
  return budget_.next_reservation(wanted, bytes_);
}

bool MemoryShare::try_hold(std::uint64_t bytes) {
  const std::uint64_t wanted = std::min(bytes, budget_.limit_);
  return try_reserve(wanted, wanted);
}

bool MemoryShare::try_reserve(std::uint64_t wanted, std::uint64_t needed) {
  std::uint64_t reserved = budget_.reserved_;
  do {
    if (budget_.used_by_others(reserved, bytes_) + needed > budget_.limit_) return false;
  } while (!budget_.reserved_.compare_exchange_weak(reserved, reserved - bytes_ + wanted));
  note(wanted);
  return true;
}

void MemoryShare::resize(std::uint64_t bytes) {
  budget_.reserved_ += bytes;
  budget_.reserved_ -= bytes_;
  note(bytes);
}

void MemoryShare::note(std::uint64_t bytes) {
  if (bytes_ == 0 && bytes > 0) ++budget_.holders_;
  if (bytes_ > 0 && bytes == 0) --budget_.holders_;
  bytes_ = bytes;
}

}  // namespace remesh::server
