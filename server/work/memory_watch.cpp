#include "server/work/memory_watch.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "api/machine_limits.h"
#include "server/observe/log.h"

namespace remesh::server {
namespace {

/// How long the memory of an ended request may take to be freed before the next request is ended.
constexpr std::chrono::milliseconds kPatience{500};
/// Free memory that the allocator may retain.
constexpr std::uint64_t kSlack = 64 << 20;

}  // namespace

MemoryWatch::MemoryWatch(MemoryBudget& budget, RequestRegistry& registry, std::chrono::milliseconds period)
    : budget_(budget), registry_(registry), looks_(period, [this] { look(api::resident_memory()); }) {}

void MemoryWatch::look(std::uint64_t resident) {
  budget_.note_resident(resident);
  const std::vector<std::shared_ptr<RunningRequest>> computing = registry_.computing();
  if (resident > last_resident_ && !computing.empty()) {
    // Nobody can tell which request has grown. But the one that is always there when memory grows soon stands out.
    const std::uint64_t share = (resident - last_resident_) / computing.size();
    for (const auto& request : computing) request->growth += share;
  }
  last_resident_ = resident;

  if (computing.empty()) {
    give_back(resident);
  } else if (resident > budget_.limit() && Clock::now() > patience_until_) {
    const auto largest = *std::max_element(computing.begin(), computing.end(),
                                           [](const auto& a, const auto& b) { return a->growth < b->growth; });
    log::write(log::Level::kWarning, "over the memory budget, ending the largest request",
               {{"id", largest->id}, {"resident", static_cast<std::int64_t>(resident)}});
    // Other holders of memory may be waiting, sending or buffered. With them gone there may be room for this request.
    largest->evict(/*was_alone=*/computing.size() == 1 && budget_.holders() <= 1);
    patience_until_ = Clock::now() + kPatience;
  }
}

/// Returns memory to the system that the allocator has retained. There is time for that between requests.
void MemoryWatch::give_back(std::uint64_t resident) {
  if (resident <= resident_after_trim_ + kSlack) return;
  ::malloc_trim(0);
  resident_after_trim_ = api::resident_memory();
}

}  // namespace remesh::server
