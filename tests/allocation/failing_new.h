/// Replaces `operator new` of this program by one that fails where it is told to.
#pragma once

#include <cstdint>

namespace remesh::allocation {

/// The n-th allocation from now on fails, once, in whatever thread that is; 0: none.
void fail_at(std::uint64_t n);
/// Those of the calling thread do not count from now on: it is the test's client.
void spare_this_thread();
/// Whether it has failed since.
bool has_failed();
/// Allocations that have not been freed.
std::int64_t live();

}  // namespace remesh::allocation
