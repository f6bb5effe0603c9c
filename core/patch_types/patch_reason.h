/// The reasons why a patch was not remeshed.
#pragma once

#include <cstdint>
#include <string_view>

namespace remesh {

enum class PatchReason : std::uint8_t {
  kNone,
  kSelfIntersectingLoop,
  kOverlappingFaces,
  kNotPlanar,
  kBudget,
  kVerificationFailed
};

/// The stable name of a reason; empty for kNone.
std::string_view reason_name(PatchReason reason);

}  // namespace remesh
