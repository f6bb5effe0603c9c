/// Chooses the faces from which regions grow.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/surface.h"

namespace remesh {

/// A face from which a region grows. The largest face comes first; among equally large ones, the one at the smallest
/// place.
struct Seed {
  double area = -1;
  Vec3 place;
  FaceId face;
  bool is_before(const Seed& b) const {
    if (area != b.area) return area > b.area;
    return place != b.place ? place < b.place : face < b.face;
  }
};

/// Gives some faces in the order of seeds. Most faces get their region from another face, so that only a few are ever
/// needed as seeds. Therefore each block of faces stores its first seed, and is searched again when that seed has been
/// taken.
class Seeds {
 public:
  Seeds(const Surface& surface, const FaceGeometries& geometry, RunControl& control)
      : surface_(surface), geometry_(geometry), control_(control) {}

  /// Starts again with these faces. The span must exist as long as `next` is called.
  void begin(std::span<const std::uint32_t> faces) {
    faces_ = faces;
    looks_left_ = kLooks * faces.size();
    first_of_block_.clear();
    is_sorted_ = false;
    sorted_.clear();
    next_ = 0;
  }

  /// The next face that is still free; invalid at the end. A face that is not free must never become free again.
  template <class IsFree>
  FaceId next(const IsFree& is_free) {
    if (!is_sorted_ && looks_left_ > 0) return first(is_free);
    if (!is_sorted_) sort(is_free);
    while (next_ < sorted_.size() && !is_free(sorted_[next_])) ++next_;
    return next_ < sorted_.size() ? sorted_[next_++] : FaceId();
  }

  Seed placed(FaceId f) const { return {geometry_[f].area, face_centre(surface_, f), f}; }

 private:
  /// Each face may be looked at this many times on average before the faces are sorted.
  static constexpr std::size_t kLooks = 8;
  static constexpr std::size_t kFacesPerBlock = 4096;

  template <class IsFree>
  Seed first_of(std::size_t begin, std::size_t end, const IsFree& is_free) const {
    Seed best;
    for (std::size_t i = begin; i < end; ++i) {
      const FaceId f(faces_[i]);
      if (!is_free(f) || geometry_[f].area < best.area) continue;
      const Seed other = placed(f);
      if (!best.face.is_valid() || other.is_before(best)) best = other;
    }
    return best;
  }

  template <class IsFree>
  FaceId first(const IsFree& is_free) {
    const bool is_new = first_of_block_.empty();
    first_of_block_.resize((faces_.size() + kFacesPerBlock - 1) / kFacesPerBlock);
    stale_.clear();
    for (std::size_t block = 0; block < first_of_block_.size(); ++block)
      if (const FaceId f = first_of_block_[block].face; is_new || (f.is_valid() && !is_free(f)))
        stale_.push_back(block);
    looks_left_ -= std::min(looks_left_, first_of_block_.size() + kFacesPerBlock * stale_.size());
    for_blocks(stale_.size(), 1, control_, [&](std::size_t i, std::size_t) {
      const std::size_t begin = kFacesPerBlock * stale_[i];
      first_of_block_[stale_[i]] = first_of(begin, std::min(faces_.size(), begin + kFacesPerBlock), is_free);
    });
    Seed best;
    for (const Seed& other : first_of_block_)
      if (other.face.is_valid() && (!best.face.is_valid() || other.is_before(best))) best = other;
    return best.face;
  }

  template <class IsFree>
  void sort(const IsFree& is_free) {
    is_sorted_ = true;
    const auto free = select_ids<std::uint32_t>(faces_.size(), kFacesPerBlock, control_,
                                                [&](std::size_t i) { return is_free(FaceId(faces_[i])); });
    std::vector<Seed> all(free.size());
    sorted_.resize(free.size());
    const auto for_each = [&](const auto& visit) {
      for_blocks(all.size(), kFacesPerBlock, control_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) visit(i);
      });
    };
    for_each([&](std::size_t i) { all[i] = placed(FaceId(faces_[free[i]])); });
    sort_stoppable(all.begin(), all.end(), control_, [](const Seed& a, const Seed& b) { return a.is_before(b); });
    for_each([&](std::size_t i) { sorted_[i] = all[i].face; });
  }

  const Surface& surface_;
  const FaceGeometries& geometry_;
  RunControl& control_;
  std::span<const std::uint32_t> faces_;
  std::size_t looks_left_ = 0;
  std::vector<Seed> first_of_block_;  ///< invalid if no face of the block is free
  std::vector<std::size_t> stale_;
  bool is_sorted_ = false;
  std::vector<FaceId> sorted_;
  std::size_t next_ = 0;
};

}  // namespace remesh
