/// Threads that let others go first.
#pragma once

namespace remesh::server {

/// Sets the calling thread behind those that answer, which need little time, but at once. Where the system does not do
/// that, it is no harm. Done once a thread, however often it is asked for.
void be_nice();

}  // namespace remesh::server
