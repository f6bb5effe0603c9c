/// Replaces `operator new` of this program by one that fails when it is told to.
#pragma once

#include <cstdint>

namespace remesh::allocation {

/// Makes the n-th allocation from now on fail, once, in whatever thread that is. If n is 0, none fails.
void fail_at(std::uint64_t n);
/// Stops counting the allocations of the calling thread, which is the client of the test.
void spare_this_thread();
/// Returns whether an allocation has failed since the last fail_at().
bool has_failed();
/// Returns the number of allocations that have not been freed.
std::int64_t live();

}  // namespace remesh::allocation
