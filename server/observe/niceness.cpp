#include "server/observe/niceness.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace remesh::server {

void be_nice() {
  constexpr int kNiceness = 10;
  // Linux lets the niceness of a single thread be changed.
  static thread_local const int set = [] {
    const auto thread = static_cast<id_t>(::syscall(SYS_gettid));
    return ::setpriority(PRIO_PROCESS, thread, ::getpriority(PRIO_PROCESS, thread) + kNiceness);
  }();
  (void)set;
}

}  // namespace remesh::server
