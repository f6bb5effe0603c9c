#include "core/output/run/coarsening_proof.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/trees/box_tree.h"
#include "core/verify/near_faces/near_faces.h"

namespace remesh {
namespace {

bool is_before(const Corners3& a, const Corners3& b) { return a < b; }

}  // namespace

CoarseningFaults CoarseningProof::check(const Coarsened& made) {
  std::vector<Corners3> now, near;
  now.reserve(made.faces.size());
  StopCheck check(control_);
  for (const Triangle& t : made.faces) {
    check();
    now.push_back({made.positions[t[0]], made.positions[t[1]], made.positions[t[2]]});
  }
  std::vector<FaceId> asked;
  for (FaceId f(0); f.value < now.size(); ++f.value) {
    check();
    if (!std::binary_search(near_.begin(), near_.end(), now[f.value], is_before)) asked.push_back(f);
  }
  std::vector<Corners3> sorted = now;
  sort_stoppable(sorted.begin(), sorted.end(), control_, is_before);
  CoarseningFaults faults;
  faults.far_input_faces = far_faces(input_.positions.items(), input_.faces, input_faces_to_check(sorted),
                                     made.positions.items(), made.faces);
  faults.far_faces = far_faces(made.positions.items(), made.faces, asked, input_.positions.items(), input_.faces);
  for (FaceId f(0); f.value < now.size(); ++f.value)
    if (!std::binary_search(faults.far_faces.begin(), faults.far_faces.end(), f)) near.push_back(now[f.value]);
  sort_stoppable(near.begin(), near.end(), control_, is_before);
  near_ = std::move(near);
  all_ = std::move(sorted);
  far_input_ = faults.far_input_faces;
  is_first_ = false;
  return faults;
}

/// Returns the input's faces that were far, and those that may have been near a face that is no longer there.
/// Input: the faces that are there now, ascending.
std::vector<FaceId> CoarseningProof::input_faces_to_check(const std::vector<Corners3>& now) const {
  const std::size_t n = input_.faces.size();
  std::vector<std::uint8_t> is_asked(n, is_first_ ? 1 : 0);
  for (const FaceId f : far_input_) is_asked[f.value] = 1;
  std::vector<Corners3> gone;
  std::set_difference(all_.begin(), all_.end(), now.begin(), now.end(), std::back_inserter(gone), is_before);
  if (!gone.empty()) {
    const auto entries = BoxTree<NoTag>::make_entries(gone.size(), control_, [&](std::size_t i, auto& entry) {
      for (const Vec3& p : gone[i]) entry.box.add(p);
    });
    const BoxTree<NoTag> tree(entries, control_);
    for_blocks(n, 64, control_, [&](std::size_t begin, std::size_t end) {
      for (FaceId f(begin); f.value < end; ++f.value) {
        FloatBox box;
        for (const VertexId v : input_.faces[f]) box.add(input_.positions[v]);
        double squared = std::nextafter(tolerance_ * tolerance_, HUGE_VAL);
        tree.search(
            squared, [&](const BoxTree<NoTag>::Entry& entry) { return squared_distance(entry.box, box); },
            [&](std::size_t) {
              is_asked[f.value] = 1;
              squared = 0;
            });
      }
    });
  }
  std::vector<FaceId> asked;
  for (FaceId f(0); f.value < n; ++f.value)
    if (is_asked[f.value] != 0) asked.push_back(f);
  return asked;
}

/// Returns those of the faces asked for that are too far from another surface, ascending.
std::vector<FaceId> CoarseningProof::far_faces(std::span<const Vec3> positions, const IdVector<FaceId, Triangle>& faces,
                                               const std::vector<FaceId>& asked, std::span<const Vec3> others,
                                               const IdVector<FaceId, Triangle>& other_faces) const {
  std::vector<FaceId> far;
  if (asked.empty()) return far;
  std::vector<Triangle> from;
  from.reserve(asked.size());
  for (const FaceId f : asked) from.push_back(faces[f]);
  const verification::OneWayDistance measured =
      verification::distance_from({positions, from}, {others, other_faces.items()}, tolerance_, control_);
  if (measured.far_count > measured.far_faces.size()) return asked;  // not all of them are known
  for (const verification::FarFace& face : measured.far_faces) far.push_back(asked[face.face.value]);
  std::sort(far.begin(), far.end());
  return far;
}

}  // namespace remesh
