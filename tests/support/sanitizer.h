/// Whether this is a build with AddressSanitizer or ThreadSanitizer: slower by ten times and more, and larger.
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

/// The size of a test, or the smaller one that a sanitizer leaves time for, which is said.
template <typename Size>
Size unless_sanitized(Size size, Size smaller) {
  if (!kIsSanitized) return size;
  std::cout << "scaled down for the sanitizer: " << smaller << " instead of " << size << "\n";
  return smaller;
}

}  // namespace remesh
