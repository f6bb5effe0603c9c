/// Why a patch was not remeshed.
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

/// The stable name; empty for kNone.
std::string_view reason_name(PatchReason reason);

}  // namespace remesh
