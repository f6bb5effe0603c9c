/// Lowers the priority of computing threads.
#pragma once

namespace remesh::server {

/// Lowers the priority of the calling thread, so that the threads that answer requests come first: they need little
/// time, but at once. If the system does not allow it, nothing happens. Only the first call in a thread has an effect.
void be_nice();

}  // namespace remesh::server
