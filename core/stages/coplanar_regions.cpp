#include "core/stages/coplanar_regions.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "core/base/tolerance.h"

namespace remesh {
namespace {

/// A face thinner than this many tolerances has no normal worth asking.
constexpr double kThin = 2;
/// Neighbours must be this many tolerances high to bear witness of noise.
constexpr double kWitness = 8;
/// Faces are held within this part of the tolerance on either side of the plane, so that input and output, both in that
/// band, are never further apart than the tolerance. While the plane is still being fitted all of it is allowed.
constexpr double kBand = 0.5;
/// A face is looked at by at most this many growths that end up without it; then only by those that have their plane.
constexpr std::uint8_t kMostTrials = 8;

/// Faces accepted so far, for the plane through them: area-weighted, so that the normal depends on the rim alone.
struct Fit {
  Vec3 area_vector, moment;
  double area = 0;

  void add(const FaceGeometry& g) {
    area_vector += g.area * g.normal;
    moment += g.area * g.centre;
    area += g.area;
  }
  Plane plane() const { return {(1 / area) * moment, normalized(area_vector)}; }
};

class Growth {
 public:
  Growth(const Surface& surface, const Adjacency& adjacency, const IdVector<FaceId, FaceGeometry>& geometry,
         const CoplanarityRule& rule, Regions& regions, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        geometry_(geometry),
        rule_(rule),
        regions_(regions),
        control_(control),
        stamp_(surface.face_count(), 0),
        trials_(surface.face_count(), 0) {
    // Corners lie within [-1, 1]; the floor is relative to the diagonal.
    Box3 box;
    for (const Vec3& p : surface.local) box.add(p);
    floor_ = kToleranceFloor * box.diagonal();
  }

  void run() {
    const std::vector<FaceId> seeds = order();
    // Thin faces seed only what no other face has taken.
    for (const bool thin : {false, true}) {
      for (std::size_t i = 0; i < seeds.size(); ++i) {
        if (i % 4096 == 0) control_.progress(0.5 * (thin + static_cast<double>(i) / static_cast<double>(seeds.size())));
        if (!regions_.of_face[seeds[i]].is_valid() && (thin || !is_thin(seeds[i]))) grow_from(seeds[i]);
      }
    }
  }

 private:
  double tolerance(FaceId f) const { return tolerance_at_rung(rule_.plane_tolerance, (*rule_.rung)[f], floor_); }
  bool is_thin(FaceId f) const { return geometry_[f].height < kThin * tolerance(f); }

  /// Faces without a region, the largest first; among equally large ones the one at the smallest place.
  std::vector<FaceId> order() const {
    struct Key {
      double area;
      Vec3 place;
      FaceId face;
    };
    std::vector<Key> keys;
    for (std::uint32_t i = 0; i < surface_.face_count(); ++i) {
      const FaceId f(i);
      if (!regions_.of_face[f].is_valid()) keys.push_back({geometry_[f].area, geometry_[f].centre, f});
    }
    tbb::parallel_sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
      if (a.area != b.area) return a.area > b.area;
      return a.place != b.place ? a.place < b.place : a.face < b.face;
    });
    std::vector<FaceId> seeds(keys.size());
    std::transform(keys.begin(), keys.end(), seeds.begin(), [](const Key& k) { return k.face; });
    return seeds;
  }

  bool fits(FaceId f, const Plane& plane, double tol) const {
    for (const VertexId v : surface_.face(f))
      if (std::fabs(plane.distance(surface_.local[v])) > tol) return false;
    const FaceGeometry& g = geometry_[f];
    if (is_thin(f)) return true;
    const double cosine = dot(g.normal, plane.normal);
    // What the distance explains; the floor is per component of the normal.
    const double sine = std::max(rule_.normal_tolerance, kThin * tol / g.height);
    return cosine > 0 && 1 - cosine * cosine <= 3 * sine * sine;
  }

  template <class Accept>
  void for_each_open_neighbour(FaceId f, Accept accept) {
    for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h) {
      const std::uint32_t twin = adjacency_.twin(h);
      if (twin == Adjacency::kNone) continue;
      const FaceId g = adjacency_.face_of(twin);
      if (regions_.of_face[g].is_valid() || stamp_[g.value] == now_) continue;
      if ((*rule_.zone)[g] == (*rule_.zone)[f] && (*rule_.rung)[g] == (*rule_.rung)[f]) accept(g);
    }
  }

  /// Finds the plane of the seed's region by growing while fitting, then the region by growing in that plane.
  void grow_from(FaceId seed) {
    const Plane seed_plane = Plane{geometry_[seed].centre, geometry_[seed].normal};
    if ((*rule_.rung)[seed] == kSingleFace) {
      found_.assign(1, seed);
      close(seed_plane);
      return;
    }
    const double tol = tolerance(seed);
    Plane plane = grow_fitting(seed, seed_plane, tol);
    const double band = kBand * tol;
    const auto all_fit = [&] {
      return std::all_of(found_.begin(), found_.end(), [&](FaceId f) { return fits(f, plane, band); });
    };
    if (!all_fit()) {
      for (const FaceId f : found_)
        if (trials_[f.value] < kMostTrials) ++trials_[f.value];
      if (!fits(seed, plane, band)) plane = seed_plane;
      grow_in_plane(seed, plane, band);
    }
    close(plane);
  }

  /// A layer is tested against one plane, and the plane is fitted anew when the region has doubled: so the order within
  /// a layer does not matter.
  Plane grow_fitting(FaceId seed, Plane plane, double tol) {
    ++now_;
    Fit fit;
    const auto take = [&](FaceId f) {
      found_.push_back(f);
      if (!is_thin(f) || f == seed) fit.add(geometry_[f]);
    };
    found_.clear();
    stamp_[seed.value] = now_;
    take(seed);
    std::size_t layer_begin = 0, fitted = 1;
    while (layer_begin < found_.size()) {
      const std::size_t layer_end = found_.size();
      next_layer_.clear();
      for (std::size_t i = layer_begin; i < layer_end; ++i) {
        if (i % 4096 == 0) control_.check();
        for_each_open_neighbour(found_[i], [&](FaceId g) {
          if (trials_[g.value] >= kMostTrials || !fits(g, plane, tol)) return;
          stamp_[g.value] = now_;
          next_layer_.push_back(g);
        });
      }
      for (const FaceId g : next_layer_) take(g);
      layer_begin = layer_end;
      if (found_.size() >= 2 * fitted && fit.area > 0) {
        plane = fit.plane();
        fitted = found_.size();
      }
    }
    return fit.area > 0 ? fit.plane() : plane;
  }

  void grow_in_plane(FaceId seed, const Plane& plane, double tol) {
    ++now_;
    found_.assign(1, seed);
    stamp_[seed.value] = now_;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      if (i % 4096 == 0) control_.check();
      for_each_open_neighbour(found_[i], [&](FaceId g) {
        if (!fits(g, plane, tol)) return;
        stamp_[g.value] = now_;
        found_.push_back(g);
      });
    }
  }

  void close(const Plane& plane) {
    const RegionId region = regions_.planes.push_back(plane);
    for (const FaceId f : found_) regions_.of_face[f] = region;
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const IdVector<FaceId, FaceGeometry>& geometry_;
  const CoplanarityRule& rule_;
  Regions& regions_;
  RunControl& control_;
  double floor_ = 0;
  std::uint32_t now_ = 0;
  std::vector<std::uint32_t> stamp_;
  std::vector<std::uint8_t> trials_;
  std::vector<FaceId> found_, next_layer_;
};

}  // namespace

double tolerance_at_rung(double tolerance, std::uint8_t rung, double floor) {
  if (rung == 0) return tolerance;
  const double tighter = kLadderFactor * tolerance;
  return rung == 1 ? tighter : std::min(kLadderFactor * tighter, floor);
}

void coplanar_regions(const Surface& surface, const Adjacency& adjacency,
                      const IdVector<FaceId, FaceGeometry>& geometry, const CoplanarityRule& rule, Regions& regions,
                      RunControl& control) {
  regions.of_face.resize(surface.face_count());
  Growth(surface, adjacency, geometry, rule, regions, control).run();
}

bool is_noise_present(const Surface& surface, const Adjacency& adjacency,
                      const IdVector<FaceId, FaceGeometry>& geometry, double floor, double tolerance) {
  const auto is_witness = [&](FaceId f) { return geometry[f].height >= kWitness * tolerance; };
  const auto bend = [&](FaceId of, FaceId against) {
    const Plane plane{geometry[against].centre, geometry[against].normal};
    double most = 0;
    for (const VertexId v : surface.face(of)) most = std::max(most, std::fabs(plane.distance(surface.local[v])));
    return most;
  };
  const auto is_noise = [&](double distance) { return distance > floor && distance <= tolerance; };
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    const FaceId f(i);
    if (!is_witness(f)) continue;
    if (surface.face(f).size() > 3 && is_noise(bend(f, f))) return true;
    for (std::uint32_t h = surface.face_begin[i]; h < surface.face_begin[i + 1]; ++h) {
      const std::uint32_t twin = adjacency.twin(h);
      if (twin == Adjacency::kNone || twin < h) continue;
      const FaceId g = adjacency.face_of(twin);
      if (is_witness(g) && dot(geometry[f].normal, geometry[g].normal) > 0 && is_noise(bend(g, f))) return true;
    }
  }
  return false;
}

}  // namespace remesh
