/// Replaces the operators new and delete of a program that is linked with it, so that their bytes can be counted.
#pragma once

#include <cstdint>

namespace remesh::memory {

/// Sets a function that is told of each block when it is allocated, and with a negative number when it is freed. Null:
/// nobody is told. The function is called from any thread, and must not allocate.
void tell_allocations(void (*told)(std::int64_t bytes));

}  // namespace remesh::memory
