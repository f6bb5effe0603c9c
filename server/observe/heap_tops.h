/// The free memory at the ends of the threads' heaps. malloc_trim returns this memory for the main heap alone. Every
/// other heap retains free memory up to the allocator's threshold for trimming. It returns this memory only if one of
/// its own threads frees a block while the threshold is low. So the threads are asked to do this when they have no work
/// or have just finished some.
#pragma once

namespace remesh::server {

class HeapTops {
 public:
  /// Sets the thresholds of the allocator, before the first thread starts.
  static void set_thresholds();

  /// Asks all threads to return their free memory.
  static void ask();
  /// True if the calling thread has not returned its memory since the last `ask`.
  static bool is_asked();
  static void return_if_asked() {
    if (is_asked()) return_now();
  }
  /// Returns the free memory at the end of the calling thread's heap, if it is more than a MiB.
  static void return_now();
};

}  // namespace remesh::server
