#include "tests/support/model_claims.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "core/base/tolerance.h"

namespace remesh::test {
namespace {

constexpr double kMaxSteps = 3;
constexpr double kMaxToleranceSteps = 10;

bool is_curved(SurfaceKind kind) { return kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree; }

/// The faces of one true surface.
struct Faces {
  std::vector<FaceId> faces;
  std::map<SurfaceKind, std::size_t> wrong;  ///< their number by the kind that is claimed instead
  std::set<SurfaceId> claimed;               ///< the surfaces of the right kind
};

class Judge {
 public:
  Judge(const primitives::Model& model, const Claims& claims, double step)
      : model_(model), claims_(claims), step_(step), by_truth_(model.surfaces.size()) {
    Box3 box;
    for (const Vec3& p : model.mesh.positions) box.add(p);
    diagonal_ = box.diagonal();
  }

  std::vector<std::string> faults() {
    for (std::uint32_t f = 0; f < model_.mesh.face_count(); ++f) {
      const std::uint32_t truth = model_.surface_of[FaceId(f)];
      Faces& faces = by_truth_[truth];
      faces.faces.push_back(FaceId(f));
      if (claims_.kind_of(FaceId(f)) == model_.surfaces[truth].kind)
        faces.claimed.insert(claims_.surface_of(FaceId(f)));
      else
        ++faces.wrong[claims_.kind_of(FaceId(f))];
    }
    for (std::size_t truth = 0; truth < by_truth_.size(); ++truth) judge(truth);
    judge_counts();
    return std::move(faults_);
  }

 private:
  template <class... Parts>
  void tell(std::size_t truth, const Parts&... parts) {
    std::ostringstream text;
    text << kind_name(model_.surfaces[truth].kind) << " " << truth << ": ";
    (text << ... << parts);
    faults_.push_back(text.str());
  }

  void judge(std::size_t truth) {
    const Faces& faces = by_truth_[truth];
    const PlainSurface& surface = model_.surfaces[truth];
    for (const auto& [kind, count] : faces.wrong)
      tell(truth, count, " of ", faces.faces.size(), " faces are claimed as ", kind_name(kind));
    if (surface.kind == SurfaceKind::kFree) return;
    if (is_curved(surface.kind) && faces.claimed.size() > 1) tell(truth, "it is ", faces.claimed.size(), " surfaces");
    for (const SurfaceId s : faces.claimed) judge_place(truth, s);
    if (is_curved(surface.kind) && faces.wrong.empty() && faces.claimed.size() == 1)
      judge_record(truth, claims_.surfaces()[*faces.claimed.begin()]);
  }

  /// Judges where the claimed surface lies over the faces that are claimed for it.
  void judge_place(std::size_t truth, SurfaceId s) {
    const PlainSurface& surface = model_.surfaces[truth];
    const PlainSurface claim = plain(claims_.surfaces()[s]);
    double farthest = 0;
    const auto measure = [&](const Vec3& p) {
      const double distance = claim.distance(surface.nearest(p));
      if (!(distance <= farthest)) farthest = distance;
    };
    std::vector<Vec3> points;
    for (const FaceId f : by_truth_[truth].faces) {
      if (claims_.surface_of(f) != s) continue;
      const std::vector<Vec3> corners = corners_of(model_.mesh, f);
      Vec3 sum;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const bool is_corner = surface.distance(corners[i]) <= kMaxSteps * step_;
        if (is_corner) points.push_back(corners[i]);
        if (is_corner || surface.kind != SurfaceKind::kRevolution) measure(corners[i]);
        if (surface.kind != SurfaceKind::kRevolution) measure(0.5 * (corners[i] + corners[(i + 1) % corners.size()]));
        sum += corners[i];
      }
      if (surface.kind != SurfaceKind::kRevolution) measure((1.0 / static_cast<double>(corners.size())) * sum);
    }
    if (!(farthest <= kMaxSteps * step_)) tell(truth, "the claimed surface is ", farthest / step_, " steps away");
    const Arcs arcs = arcs_of(surface, points);
    const auto judge_radius = [&](const char* what, double claimed, double is, double arc) {
      if (arc >= 90 && !(std::fabs(claimed - is) <= kMaxSteps * step_))
        tell(truth, "the ", what, " ", claimed, " is wrong by ", (claimed - is) / step_, " steps");
    };
    if (surface.kind == SurfaceKind::kTorus) {
      judge_radius("tube's radius", claim.tube, surface.tube, arcs.tube);
      judge_radius("ring's radius", claim.radius, surface.radius, std::min(arcs.turn, arcs.tube));
    } else {
      judge_radius("radius", claim.radius, surface.radius, arcs.turn);
    }
  }

  /// Judges what the record tells about the faces, which it holds all.
  void judge_record(std::size_t truth, const RecognisedSurface& record) {
    const PlainSurface& surface = model_.surfaces[truth];
    double largest_gap = 0, chord_height = 0;
    bool is_convex = false, is_concave = false;
    std::vector<Vec3> points;
    for (const FaceId f : by_truth_[truth].faces) {
      const std::vector<Vec3> corners = corners_of(model_.mesh, f);
      Vec3 sum, area;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3& next = corners[(i + 1) % corners.size()];
        points.push_back(corners[i]);
        sum += corners[i];
        if (i > 1) area += cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
        chord_height = std::max(chord_height, surface.distance(0.5 * (corners[i] + next)));
        if (surface.kind != SurfaceKind::kSphere)
          largest_gap =
              std::max(largest_gap, covered_turn_deg(surface.point, surface.axis, std::vector{corners[i], next}));
      }
      const Vec3 middle = (1.0 / static_cast<double>(corners.size())) * sum;
      chord_height = std::max(chord_height, surface.distance(middle));
      (dot(area, surface.normal(middle)) > 0 ? is_convex : is_concave) = true;
    }
    if (surface.kind != SurfaceKind::kSphere) {
      const double turn = covered_turn_deg(surface.point, surface.axis, points);
      const double sweep = turn + 1.01 * largest_gap >= 360 ? 360 : turn;
      if (std::fabs(record.sweep_deg - sweep) > 0.1) tell(truth, "the sweep is ", record.sweep_deg, ", not ", sweep);
    }
    // The normal of a surface of revolution may look to either side.
    if (surface.kind != SurfaceKind::kRevolution) {
      const SurfaceSide side = is_convex && is_concave ? SurfaceSide::kBoth
                               : is_convex             ? SurfaceSide::kConvex
                                                       : SurfaceSide::kConcave;
      if (record.side != side) tell(truth, "the side is ", side_name(record.side), ", not ", side_name(side));
    }
    const double slack = kMaxSteps * step_ + 0.02 * chord_height;
    // How a surface of revolution bends between two circles is not known, so only its turn around the axis counts.
    const bool is_whole = surface.kind != SurfaceKind::kRevolution;
    if (!((!is_whole || record.input_chord_height >= chord_height - slack) &&
          record.input_chord_height <= 2.5 * chord_height + slack))
      tell(truth, "the chord height is ", record.input_chord_height, ", and it is at least ", chord_height);
    const double step = std::max(step_, kToleranceFloor * diagonal_);
    if (!(record.tolerance <= kMaxToleranceSteps * step))
      tell(truth, "the tolerance is ", record.tolerance / step, " steps");
    if (!(record.deviation <= record.tolerance))
      tell(truth, "the deviation ", record.deviation, " is above the tolerance ", record.tolerance);
  }

  /// Judges how many faces and how much area the curved records tell of.
  void judge_counts() {
    std::map<SurfaceId, std::pair<std::uint64_t, double>> counted;
    for (std::uint32_t f = 0; f < model_.mesh.face_count(); ++f) {
      if (!claims_.is_curved(FaceId(f))) continue;
      auto& [count, area] = counted[claims_.surface_of(FaceId(f))];
      ++count;
      area += area_of(model_.mesh, FaceId(f));
    }
    for (const auto& [s, sum] : counted) {
      const RecognisedSurface& record = claims_.surfaces()[s];
      std::ostringstream text;
      if (record.faces != sum.first) text << "record " << s << " counts " << record.faces << " faces of " << sum.first;
      if (std::fabs(record.area - sum.second) > 1e-6 * sum.second)
        text << "record " << s << " has the area " << record.area << ", its faces have " << sum.second;
      if (!text.str().empty()) faults_.push_back(text.str());
    }
  }

  const primitives::Model& model_;
  const Claims& claims_;
  double step_;
  double diagonal_ = 0;
  std::vector<Faces> by_truth_;
  std::vector<std::string> faults_;
};

}  // namespace

std::vector<std::string> faults_of(const primitives::Model& model, const Claims& claims, double step) {
  return Judge(model, claims, step).faults();
}

}  // namespace remesh::test
