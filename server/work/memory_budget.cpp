#include "server/work/memory_budget.h"

#include <algorithm>

namespace remesh::server {

std::uint64_t MemoryBudget::used_by_others(std::uint64_t reserved, std::uint64_t own) const {
  if (reserved <= own) return 0;
  return std::max<std::uint64_t>(reserved, resident_) - own;
}

std::uint64_t MemoryBudget::available() const { return limit_ - std::min(limit_, used_by_others(reserved_, 0)); }

void MemoryShare::hold_body(std::uint64_t held, std::uint64_t expected) {
  const std::uint64_t most = std::max(held, expected);
  if (most > budget_.limit_ / per_byte_) throw never_fits(budget_.limit_);
  const std::uint64_t wanted = std::max(bytes_, held * per_byte_);
  const std::uint64_t at_most = std::max(bytes_, most * per_byte_);
  std::uint64_t reserved = budget_.reserved_;
  do {
    if (budget_.used_by_others(reserved, bytes_) + at_most > budget_.limit_) throw out_of_memory();
  } while (!budget_.reserved_.compare_exchange_weak(reserved, reserved - bytes_ + wanted));
  note(wanted);
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
