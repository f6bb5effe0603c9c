/// Stores the cuts of all segments during a refinement, and messages about cuts that patches still have to apply.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// A place at which a segment is cut. The parameter t runs from 0 to 1 along the segment.
struct Cut {
  SegmentId segment;
  double t;

  friend bool operator<(const Cut& a, const Cut& b) {
    return a.segment != b.segment ? a.segment < b.segment : a.t < b.t;
  }
  friend bool operator==(const Cut&, const Cut&) = default;
};

/// A cut, and a patch that made it. If several patches made it in the same round, each has an entry.
struct FreshCut {
  Cut cut;
  PatchId by;
  friend bool operator<(const FreshCut& a, const FreshCut& b) { return a.cut == b.cut ? a.by < b.by : a.cut < b.cut; }
};

/// The cuts of all segments, which every patch beside a segment has to apply. Patches cut on their own during a round.
/// Between rounds, the cuts of one patch become messages to the others.
class SegmentCuts {
 public:
  using OfSegments = IdVector<SegmentId, std::vector<double>>;

  /// A message about cuts along a segment that other patches made and `patch` has to make too.
  struct Message {
    PatchId patch;
    SegmentId segment;
    std::uint64_t count = 0;  ///< cuts that are new to the patch
    friend bool operator<(const Message& a, const Message& b) {
      return a.patch != b.patch ? a.patch < b.patch : a.segment < b.segment;
    }
    friend bool operator==(const Message&, const Message&) = default;
  };

  SegmentCuts(const SegmentTable& segments, RunControl& control) : segments_(segments), control_(control) {}

  /// Starts again with the cuts that sizes alone require, and with messages about them to all patches.
  /// Input: If all cuts, counted once for each patch beside them, would be more than `max_triangles`, all segments are
  ///        cut less often, in the same proportion, so that half of `max_triangles` is left. It may be kNoFaceLimit. If
  ///        there are more cuts than `max_made`, the attempt ends at once. Then the cuts are only counted, in the
  ///        messages, up to one more for each segment, and not all of them are stored.
  void begin(const SizeField& sizes, std::uint64_t max_triangles, std::uint64_t max_made);

  /// Takes the cuts that patches made in a round, and makes messages of them. The old messages are deleted.
  void exchange(std::vector<FreshCut> fresh);

  /// Returns the cuts of all segments, ascending for each.
  const OfSegments& all() const { return cuts_; }
  const std::vector<double>& operator[](SegmentId s) const { return cuts_[s]; }
  /// Returns all messages, ordered by patch and segment.
  std::span<const Message> messages() const { return messages_; }
  std::span<const Message> messages_for(PatchId patch) const;

 private:
  void thin_out(const SizeField& sizes, std::uint64_t max_cuts, IdVector<SegmentId, std::uint32_t>& counts,
                double share);
  void send_to_others(SegmentId s, std::span<const FreshCut> fresh, std::uint64_t count);
  void sort_messages();

  const SegmentTable& segments_;
  RunControl& control_;
  OfSegments cuts_;
  std::vector<Message> messages_;
};

}  // namespace remesh
