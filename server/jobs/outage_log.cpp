#include "server/jobs/outage_log.h"

#include <string>
#include <utility>

#include "server/observe/log.h"

namespace remesh::server::jobs {

void OutageLog::note(std::string_view op, const StoreError* error) {
  const std::lock_guard lock(mutex_);
  if (error == nullptr) {
    if (std::exchange(is_away_, false)) log::write(log::Level::kInfo, "the job store answers again");
    return;
  }
  ++failed_;
  const Clock::time_point now = Clock::now();
  if (now < next_warning_) return;
  is_away_ = true;
  next_warning_ = now + kPeriod;
  log::write(log::Level::kWarning, "the job store fails",
             {{"op", std::string(op)}, {"error", std::string(error->what())}, {"failed", std::exchange(failed_, 0)}});
}

}  // namespace remesh::server::jobs
