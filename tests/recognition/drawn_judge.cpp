#include "tests/recognition/drawn_judge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "core/base/error.h"
#include "core/remesh.h"
#include "tests/recognition/right_claim.h"
#include "tests/recognition/triangle_boxes.h"
#include "tests/support/claims.h"

namespace remesh::recognition {
namespace {

using test::PlainSurface;

constexpr double kNearlyAll = 0.97;  ///< of a surface's area, for it to be found
constexpr double kHardlyAny = 0.01;  ///< of a surface's area, which is not held against a claim
constexpr double kSlackSteps = 3;

bool is_claimable(SurfaceKind kind) {
  return kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree && kind != SurfaceKind::kRevolution;
}

/// Points that cover a triangle.
std::vector<Vec3> points_over(const PlainTriangle& t) {
  constexpr int kParts = 3;
  std::vector<Vec3> points;
  for (int i = 0; i <= kParts; ++i)
    for (int j = 0; i + j <= kParts; ++j)
      points.push_back((1.0 / kParts) * (static_cast<double>(i) * t[0] + static_cast<double>(j) * t[1] +
                                         static_cast<double>(kParts - i - j) * t[2]));
  return points;
}

double plain_volume(const std::vector<PlainTriangle>& triangles, const Vec3& from) {
  double sum = 0;
  for (const PlainTriangle& t : triangles) sum += dot(t[0] - from, cross(t[1] - from, t[2] - from)) / 6;
  return sum;
}

double plain_area(const PlainTriangle& t) { return norm(cross(t[1] - t[0], t[2] - t[0])) / 2; }

/// True if each side of a triangle is that of one other triangle, which runs through it the other way.
bool is_closed(const PolygonMesh& mesh) {
  std::set<std::pair<VertexId, VertexId>> sides;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = mesh.face(FaceId(f));
    for (std::size_t i = 0; i < c.size(); ++i)
      if (!sides.insert({c[i], c[(i + 1) % c.size()]}).second) return false;
  }
  return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
    return sides.contains({side.second, side.first});
  });
}

class SolidJudge {
 public:
  SolidJudge(const DrawnSolid& solid, const Options& options, const Result& result)
      : solid_(solid), options_(options), result_(result), records_(result.report.surfaces.surfaces) {
    const PolygonMesh& mesh = solid.model.mesh;
    Box3 box;
    for (const Vec3& p : mesh.positions) box.add(p);
    centre_ = 0.5 * (box.min + box.max);
    diagonal_ = box.diagonal();
    double largest = 0;
    for (const Vec3& p : mesh.positions) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    noise_ = 1e-9 * diagonal_ + 1e-14 * largest;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const auto c = mesh.face(FaceId(f));
      input_.push_back({mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]});
    }
    for (const Triangle& t : result.mesh.faces)
      output_.push_back({result.mesh.positions[t[0]], result.mesh.positions[t[1]], result.mesh.positions[t[2]]});
  }

  DrawnVerdict verdict() {
    if (!(plain_volume(input_, centre_) > 0)) verdict_.error = "the drawn solid is turned inside out";
    if (!verdict_.error.empty()) tell(verdict_.error);
    judge_claims();
    judge_distances();
    judge_volume();
    return std::move(verdict_);
  }

 private:
  template <class... Parts>
  void tell(const Parts&... parts) {
    std::ostringstream text;
    (text << ... << parts);
    verdict_.faults.push_back(text.str());
  }

  SurfaceId surface_of(PatchId p) const { return p.is_valid() ? result_.report.surfaces.of_patch[p] : SurfaceId(); }
  SurfaceId claim_of(std::size_t f) const { return surface_of(result_.input_face_patch[FaceId(f)]); }
  double slack() const { return kSlackSteps * solid_.step + noise_; }

  /// Returns how far a claim is from the true surface over a face.
  double distance_over(std::size_t f, const PlainSurface& truth, const PlainSurface& claim) const {
    double farthest = 0;
    const auto measure = [&](const Vec3& p) { farthest = std::max(farthest, claim.distance(p)); };
    if (truth.kind == SurfaceKind::kPlane) {
      for (const Vec3& p : points_over(input_[f])) measure(p);
    } else {
      for (const Vec3& p : solid_.true_points[FaceId(f)]) measure(p);
    }
    return farthest;
  }

  void judge_claims() {
    std::vector<std::vector<std::size_t>> faces(solid_.names.size());
    for (std::size_t f = 0; f < input_.size(); ++f) faces[solid_.model.surface_of[FaceId(f)]].push_back(f);
    for (std::size_t truth = 0; truth < faces.size(); ++truth)
      if (!faces[truth].empty()) judge_surface(truth, faces[truth]);
  }

  void judge_surface(std::size_t of, const std::vector<std::size_t>& faces) {
    const PlainSurface& truth = solid_.model.surfaces[of];
    DrawnCounts& counts = verdict_.by_name[solid_.names[of]];
    ++counts.surfaces;
    struct Part {
      double area = 0;
      double distance = 0;
      std::vector<Vec3> corners;
    };
    std::map<SurfaceId, Part> parts;
    double whole = 0;
    for (const std::size_t f : faces) {
      const double area = plain_area(input_[f]);
      whole += area;
      const SurfaceId s = claim_of(f);
      if (!s.is_valid()) continue;
      const RecognisedSurface& record = records_[s];
      // A band of a surface of revolution is no claim of its own.
      if (!is_claimable(record.shape.kind) || record.whole.is_valid()) continue;
      Part& part = parts[s];
      part.area += area;
      part.distance = std::max(part.distance, distance_over(f, truth, test::plain(record)));
      part.corners.insert(part.corners.end(), input_[f].begin(), input_[f].end());
    }
    bool is_found = false, is_wrong = false, is_off = false;
    for (const auto& [s, part] : parts) {
      const RecognisedSurface& record = records_[s];
      const PlainSurface claim = test::plain(record);
      const double told = std::max(told_deviation(record), truth.kind == claim.kind ? solid_.off : 0.0);
      if (part.area <= kHardlyAny * whole) continue;
      const bool is_kind = truth.kind == claim.kind;
      const bool is_near = part.distance <= (is_kind ? 2 : 1) * told + slack();
      if (!is_kind) {
        if (is_near || is_right_claim(claim, solid_.also[of], part.corners, told + slack())) continue;
        is_wrong = true;
      } else if (!is_near || !is_right_claim(claim, truth, part.corners, std::max(told, solid_.off) + slack())) {
        is_off = true;
      } else {
        is_found = is_found || part.area >= kNearlyAll * whole;
        continue;
      }
      tell(kind_name(truth.kind), " ", of, " (", solid_.names[of], ") is claimed as ", kind_name(claim.kind), " ", s,
           " with r ", claim.radius, " ", claim.tube, " for ", 100 * part.area / whole, " % of its area, ",
           part.distance, " away; told ", told_deviation(record), ", a step is ", solid_.step, ", the radii are ",
           truth.radius, " ", truth.tube);
    }
    ++(is_wrong ? counts.wrong : is_off ? counts.off : is_found ? counts.found : counts.missed);
  }

  /// Returns the chord height that is asked for on a true surface. It is that of the largest circle that it has.
  double asked_chord(std::size_t of, const std::vector<Vec3>& corners) const {
    const double n = options_.elements_per_circle.value_or(0);
    if (n == 0) return 0;
    const PlainSurface& s = solid_.model.surfaces[of];
    double radius = std::max(s.radius + s.tube, s.tube);
    if (s.kind == SurfaceKind::kPlane) return 0;
    if (s.kind == SurfaceKind::kCone)
      for (const Vec3& p : corners) radius = std::max(radius, norm(cross(p - s.point, s.axis)));
    return radius * (1 - std::cos(std::numbers::pi / n));
  }

  void judge_distances() {
    const TriangleBoxes in(input_), out(output_);
    std::map<SurfaceId, double> farthest;
    double whole = 0;
    std::vector<double> of_truth(solid_.names.size());
    std::vector<std::vector<Vec3>> corners(solid_.names.size());
    for (std::size_t f = 0; f < input_.size(); ++f) {
      const std::uint32_t truth = solid_.model.surface_of[FaceId(f)];
      corners[truth].insert(corners[truth].end(), input_[f].begin(), input_[f].end());
      double here = 0;
      for (const Vec3& p : points_over(input_[f])) here = std::max(here, out.distance(p));
      whole = std::max(whole, here);
      const SurfaceId s = claim_of(f);
      if (s.is_valid()) farthest[s] = std::max(farthest[s], here);
      // Faces of no kind may be made coarser by a tolerance of their own, which is told.
      const bool is_free = s.is_valid() && records_[s].shape.kind == SurfaceKind::kFree;
      if (!is_free) of_truth[truth] = std::max(of_truth[truth], here);
    }
    for (std::size_t f = 0; f < output_.size(); ++f) {
      const SurfaceId s = surface_of(result_.face_patch[FaceId(f)]);
      for (const Vec3& p : points_over(output_[f])) {
        const double here = in.distance(p);
        if (s.is_valid()) farthest[s] = std::max(farthest[s], here);
        whole = std::max(whole, here);
      }
    }
    for (const auto& [s, distance] : farthest) {
      const RecognisedSurface& record = records_[s];
      if (record.shape.kind == SurfaceKind::kPlane || record.shape.kind == SurfaceKind::kFree) continue;
      const double told = std::max(record.bound, record.whole.is_valid() ? records_[record.whole].bound : 0.0);
      if (told > noise_) ++verdict_.remeshed;
      // The input's facets may also be the walls of a detail that was dropped, which are as far as a step.
      if (distance <= told + solid_.step + noise_) continue;
      ++verdict_.moved;
      tell(kind_name(record.shape.kind), " ", s, " is ", distance, " from the other mesh; told ", told);
    }
    const auto& bound = result_.report.distance_bound;
    const double told = bound ? std::max(bound->input_to_output, bound->output_to_input) : 0;
    if (!(whole <= told + noise_)) {
      ++verdict_.moved;
      tell("input and result are ", whole, " apart; told ", told);
    }
    for (std::size_t of = 0; of < of_truth.size(); ++of) {
      const SurfaceKind kind = solid_.model.surfaces[of].kind;
      if (kind == SurfaceKind::kFree || kind == SurfaceKind::kPlane) continue;
      const double explained = 2 * solid_.chord[of] + asked_chord(of, corners[of]) + 2 * solid_.off + 2 * slack();
      if (of_truth[of] <= explained) continue;
      ++verdict_.unexplained;
      tell(kind_name(kind), " ", of, " (", solid_.names[of], ") has moved by ", of_truth[of], "; its chords explain ",
           explained);
    }
  }

  void judge_volume() {
    std::map<SurfaceId, std::pair<double, double>> areas;
    double all = 0;
    for (std::size_t f = 0; f < input_.size(); ++f) {
      all += plain_area(input_[f]);
      if (const SurfaceId s = claim_of(f); s.is_valid()) areas[s].first += plain_area(input_[f]);
    }
    for (std::size_t f = 0; f < output_.size(); ++f)
      if (const SurfaceId s = surface_of(result_.face_patch[FaceId(f)]); s.is_valid())
        areas[s].second += plain_area(output_[f]);
    double bound = all * (solid_.step + noise_);
    for (const auto& [s, area] : areas) {
      const RecognisedSurface& record = records_[s];
      const double told = std::max(record.bound, record.whole.is_valid() ? records_[record.whole].bound : 0.0);
      bound += std::max(area.first, area.second) * told;
    }
    const double change = std::fabs(plain_volume(output_, centre_) - plain_volume(input_, centre_));
    if (change <= bound) return;
    verdict_.is_volume_right = false;
    tell("the volume has changed by ", change, "; the told distances explain ", bound);
  }

  const DrawnSolid& solid_;
  const Options& options_;
  const Result& result_;
  const IdVector<SurfaceId, RecognisedSurface>& records_;
  std::vector<PlainTriangle> input_, output_;
  Vec3 centre_;
  double diagonal_ = 0;
  double noise_ = 0;  ///< the arithmetic's
  DrawnVerdict verdict_;
};

}  // namespace

void DrawnCounts::add(const DrawnCounts& other) {
  surfaces += other.surfaces;
  found += other.found;
  missed += other.missed;
  wrong += other.wrong;
  off += other.off;
}

Options circle_options(double elements_per_circle) {
  Options options;
  options.elements_per_circle = elements_per_circle;
  return options;
}

Options volume_options() {
  Options options = circle_options(16);
  options.proximity = 0.25;
  return options;
}

DrawnVerdict judge_solid(const DrawnSolid& solid, const Options& options) {
  RunControl control;
  RunSettings settings;
  settings.want_face_source = true;
  if (!is_closed(solid.model.mesh)) {
    DrawnVerdict open;
    open.error = "the drawn solid is not closed";
    open.faults.push_back(open.error);
    return open;
  }
  try {
    const Result result = remesh_surface(solid.model.mesh, options, settings, control);
    return SolidJudge(solid, options, result).verdict();
  } catch (const Error& error) {
    DrawnVerdict verdict;
    verdict.error = error.what();
    verdict.faults.push_back("the run fails: " + verdict.error);
    return verdict;
  }
}

}  // namespace remesh::recognition
