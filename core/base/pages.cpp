#include "core/base/pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace remesh {

void take_pages(void* memory, std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  static const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  // Less is most often of memory that was there before, and asking for it would take longer than what it spares.
  constexpr std::size_t kLeast = std::size_t{1} << 18;
  // Those that lie within it as a whole; the kernel refuses what it cannot do, and they come one by one.
  const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(memory) % page) % page;
  if (bytes < std::max(kLeast, before + page)) return;
  (void)::madvise(static_cast<std::byte*>(memory) + before, (bytes - before) / page * page, MADV_POPULATE_WRITE);
#else
  (void)memory;
  (void)bytes;
#endif
}

}  // namespace remesh
