/// What this process may use of the machine that it runs on.
#pragma once

#include <cstdint>

namespace remesh::api {

/// The number of cores this process may use: its affinity mask and its control group's quota (rounded up), at least 1.
int usable_cores();

/// The cores that a cgroup v2 `cpu.max` grants ("150000 100000" is 1.5, rounded up to 2), or 0 for no limit.
int cores_of_quota(const char* cpu_max);

/// The bytes of memory this process may use: of the machine, its control group and its limit on address space the
/// least.
std::uint64_t usable_memory();

/// The bytes of memory it uses now; 0 where that cannot be told.
std::uint64_t resident_memory();

/// From now on, memory beyond so many bytes is refused (std::bad_alloc): else the system would end this process, or
/// others, when there is none left. All that can be written to counts, touched or not: the stacks of threads as well,
/// and a thread that finds no room for its own ends the process. Does nothing where more than that is reserved already,
/// as sanitizers do.
/// Output: whether it is so now.
bool limit_own_memory(std::uint64_t bytes);

}  // namespace remesh::api
