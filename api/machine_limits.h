/// The resources of the machine that this process may use.
#pragma once

#include <cstdint>

namespace remesh::api {

/// The number of cores this process may use: its affinity mask and its control group's quota (rounded up), at least 1.
int usable_cores();

/// The number of cores that a cgroup v2 `cpu.max` grants, rounded up ("150000 100000" means 1.5 and gives 2), or 0
/// for no limit.
int cores_of_quota(const char* cpu_max);

/// The bytes of memory that this process may use: the smallest of the machine's memory, the limits of its control
/// groups and its limit on address space.
std::uint64_t usable_memory();

/// The bytes of memory that this process uses now; 0 if that cannot be found out.
std::uint64_t resident_memory();

/// From now on, refuses memory beyond this many bytes with std::bad_alloc. Otherwise the system would kill this
/// process, or others, once memory runs out. All writable memory counts, whether touched or not. That includes the
/// stacks of threads, and a thread without room for its stack ends the process. If more memory than `bytes` is
/// reserved already, as sanitizers do, nothing is changed.
/// Output: true if the limit is now in force.
bool limit_own_memory(std::uint64_t bytes);

}  // namespace remesh::api
