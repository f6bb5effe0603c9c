#include "server/jobs/store_deadline.h"

namespace remesh::server::jobs {
namespace {

thread_local Clock::time_point shared_deadline = Clock::time_point::max();

}  // namespace

SharedStoreDeadline::SharedStoreDeadline(Clock::time_point time) : before_(shared_deadline) {
  shared_deadline = std::min(before_, time);
}

SharedStoreDeadline::~SharedStoreDeadline() { shared_deadline = before_; }

Clock::time_point SharedStoreDeadline::current(Clock::time_point otherwise) {
  return shared_deadline == Clock::time_point::max() ? otherwise : shared_deadline;
}

}  // namespace remesh::server::jobs
