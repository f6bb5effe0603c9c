#include "core/stages/weld.h"

#include <tbb/parallel_sort.h>

#include <cmath>
#include <map>
#include <tuple>

namespace remesh {
namespace {

struct Indexed {
  Vec3 position;
  std::uint32_t index;

  friend bool operator<(const Indexed& a, const Indexed& b) {
    return a.position != b.position ? a.position < b.position : a.index < b.index;
  }
};

/// Coordinates below this, in local units, count as 0: predicates must not underflow.
constexpr double kLeastLocal = 0x1p-100;

void set_local_units(Surface& surface) {
  Box3 box;
  for (const Vec3& p : surface.positions) box.add(p);
  const Vec3 centre = 0.5 * box.min + 0.5 * box.max;
  surface.centre = centre;
  const Vec3 half = box.max - centre;
  int exponent = 0;
  std::frexp(std::max({half.x, half.y, half.z}), &exponent);
  surface.unit = std::ldexp(1.0, exponent);
  surface.local.reserve(surface.positions.size());
  for (const Vec3& p : surface.positions) {
    Vec3 q;
    for (int axis = 0; axis < 3; ++axis) {
      q[axis] = (p[axis] - centre[axis]) / surface.unit;
      if (std::fabs(q[axis]) < kLeastLocal) q[axis] = 0;
    }
    surface.local.push_back(q);
  }
}

IdVector<FaceId, std::uint32_t> number_labels(const FaceLabels& labels, const Barriers& barriers, std::size_t faces) {
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
  std::map<Key, std::uint32_t> number_of;
  IdVector<FaceId, std::uint32_t> numbers(faces, 0);
  const auto label = [](const LabelSet& set, bool is_barrier, FaceId f) {
    return is_barrier && set.is_used() ? set.of_face[f] : 0u;
  };
  for (std::size_t i = 0; i < faces; ++i) {
    const FaceId f(i);
    const Key key{label(labels.object, barriers.object, f), label(labels.group, barriers.group, f),
                  label(labels.material, barriers.material, f)};
    numbers[f] = number_of.try_emplace(key, static_cast<std::uint32_t>(number_of.size())).first->second;
  }
  return numbers;
}

}  // namespace

Surface weld(const PolygonMesh& input, const Barriers& barriers, std::vector<Diagnostic>& diagnostics,
             RunControl& control) {
  if (input.face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kWeld, "the mesh has no face");
  const std::size_t n = input.vertex_count();
  Diagnostic unused{DiagnosticCode::kUnusedVertex, 0, {}, "vertices that no face uses were dropped"};
  Diagnostic duplicate{DiagnosticCode::kDuplicateVertex, 0, {}, "vertices with equal coordinates were made one"};

  std::vector<std::uint8_t> is_used(n, 0);
  for (const VertexId v : input.corners) is_used[v.value] = 1;
  std::vector<Indexed> sorted;
  sorted.reserve(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (is_used[i])
      sorted.push_back({input.positions[VertexId(i)], i});
    else
      unused.add(i);
  }
  control.check();
  tbb::parallel_sort(sorted.begin(), sorted.end());
  control.check();

  std::vector<std::uint32_t> first_equal(n);
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const bool is_first = k == 0 || sorted[k].position != sorted[k - 1].position;
    first_equal[sorted[k].index] = is_first ? sorted[k].index : first_equal[sorted[k - 1].index];
  }

  control.check();
  Surface surface;
  std::vector<VertexId> welded(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (!is_used[i]) continue;
    if (first_equal[i] == i) {
      welded[i] = surface.positions.push_back(input.positions[VertexId(i)]);
      surface.vertex_source.push_back(VertexId(i));
    } else {
      welded[i] = welded[first_equal[i]];  // smaller, so it has its number already
      duplicate.add(i);
    }
  }
  control.check();
  set_local_units(surface);
  control.check();

  surface.face_begin = input.face_begin;
  surface.corners.reserve(input.corners.size());
  for (const VertexId v : input.corners) surface.corners.push_back(welded[v.value]);
  surface.face_source.reserve(input.face_count());
  for (std::size_t f = 0; f < input.face_count(); ++f) surface.face_source.push_back(FaceId(f));
  surface.face_label = number_labels(input.labels, barriers, input.face_count());

  for (Diagnostic* d : {&duplicate, &unused})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
  return surface;
}

}  // namespace remesh
