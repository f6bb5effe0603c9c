/// Tells whether this is a build with AddressSanitizer or ThreadSanitizer, which is at least ten times slower and
/// needs more memory.
#pragma once

#include <iostream>

namespace remesh {

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define REMESHD_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(REMESHD_SANITIZED)
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

/// Returns the size of a test, or the smaller one in a build with a sanitizer. The smaller size is printed.
template <typename Size>
Size unless_sanitized(Size size, Size smaller) {
  if (!kIsSanitized) return size;
  std::cout << "scaled down for the sanitizer: " << smaller << " instead of " << size << "\n";
  return smaller;
}

}  // namespace remesh
