#include "core/base/prefault_pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace remesh {

void prefault_pages(void* memory, std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  static const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  // Smaller blocks mostly reuse memory that the process already has, and asking the system would cost more than it
  // saves.
  constexpr std::size_t kLeast = std::size_t{1} << 18;
  // The system is asked only for pages that lie wholly within the memory. If the kernel refuses, the pages come one by
  // one as they are touched.
  const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(memory) % page) % page;
  if (bytes < std::max(kLeast, before + page)) return;
  (void)::madvise(static_cast<std::byte*>(memory) + before, (bytes - before) / page * page, MADV_POPULATE_WRITE);
#else
  (void)memory;
  (void)bytes;
#endif
}

}  // namespace remesh
