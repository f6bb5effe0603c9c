/// The loads; each starts a daemon of its own, prints what it measured, and returns an exit code.
#pragma once

#include <cstddef>

namespace remesh::load {

/// So many connections that send a byte now and then, and as many that read as slowly, hold nobody up.
int slow(std::size_t connections);

/// Three times what the daemon can do: it goes on doing what it can, and turns the rest away at once.
int overload(double seconds);

/// So many requests, a tenth of them broken and a tenth cut off: nothing grows, and all are counted.
int soak(std::size_t requests);

}  // namespace remesh::load
