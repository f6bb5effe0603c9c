#include "tests/recognition/judged_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/remesh.h"
#include "tests/recognition/right_claim.h"
#include "tests/recognition/triangle_boxes.h"
#include "tests/support/unrefined_options.h"

namespace remesh::recognition {
namespace {

constexpr double kMaxOffSteps = 6;
constexpr std::size_t kMinFacets = 4;
/// Corners of tessellations are floats, so the truth is known to about a step.
constexpr double kMaxTruthSteps = 2;

bool is_curved(SurfaceKind kind) { return kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree; }

/// True if all corners of a STEP face lie within some distance of a surface.
bool is_on(const PolygonMesh& mesh, const StepFace& face, const test::PlainSurface& surface, double distance) {
  for (std::uint32_t f = face.first; f < face.first + face.count; ++f)
    for (const Vec3& p : test::corners_of(mesh, FaceId(f)))
      if (!(surface.distance(p) <= distance)) return false;
  return true;
}

FaceVerdict judge_face(const PolygonMesh& mesh, const StepFace& face, const JudgedFile& file) {
  FaceVerdict verdict;
  verdict.face = &face;
  verdict.shape = shape_of(mesh, face, file.claims.face_patch);
  verdict.is_judged = verdict.shape.off <= kMaxOffSteps * file.step &&
                      (verdict.shape.facets >= kMinFacets || face.surface.kind == SurfaceKind::kPlane);
  for (std::uint32_t f = face.first; f < face.first + face.count; ++f) {
    const SurfaceId s = file.claims.surface_of(FaceId(f));
    const bool is_claimed = file.claims.is_curved(FaceId(f)) || (face.surface.kind == SurfaceKind::kPlane &&
                                                                 file.claims.kind_of(FaceId(f)) == SurfaceKind::kPlane);
    verdict.parts[is_claimed ? s : SurfaceId()].area += test::area_of(mesh, FaceId(f));
  }
  for (auto& [s, part] : verdict.parts) {
    if (!s.is_valid()) continue;
    part.error = error_of(mesh, face, verdict.shape, test::plain(file.claims.surfaces()[s]), file.step);
    if (part.error.is_right(file.step)) verdict.right += part.area;
  }
  return verdict;
}

void add_to(KindAreas& sum, const FaceVerdict& verdict, const PolygonMesh& mesh, const JudgedFile& file) {
  ++sum.faces;
  sum.all += verdict.shape.area;
  if (verdict.is_judged) {
    ++sum.judged_faces;
    sum.judged += verdict.shape.area;
    sum.right += verdict.right;
  }
  for (const auto& [s, part] : verdict.parts) {
    const bool is_claimed = s.is_valid() && is_curved(file.claims.surfaces()[s].shape.kind);
    if (is_claimed) sum.claimed += part.area;
    if (verdict.face->surface.kind == SurfaceKind::kFree) {
      if (is_claimed && is_on(mesh, *verdict.face, test::plain(file.claims.surfaces()[s]), kMaxOffSteps * file.step))
        sum.fitting += part.area;
    } else if (verdict.is_judged && !part.error.is_right(file.step)) {
      (!s.is_valid() ? sum.unclaimed : part.error.is_kind_right ? sum.wrong_shape : sum.wrong_kind) += part.area;
    }
  }
}

/// Adds what is claimed of a face with enough evidence, held against what the records tell.
void add_evident(KindAreas& sum, const FaceVerdict& verdict, const PolygonMesh& mesh, const JudgedFile& file) {
  const StepFace& face = *verdict.face;
  std::vector<Vec3> corners;
  for (std::uint32_t f = face.first; f < face.first + face.count; ++f)
    for (const Vec3& p : test::corners_of(mesh, FaceId(f))) corners.push_back(p);
  const std::set<Vec3> different(corners.begin(), corners.end());
  const Evidence evidence{verdict.shape.facets, different.size(), verdict.shape.off};
  if (!evidence.is_enough(face.surface, corners)) return;
  sum.evident += verdict.shape.area;
  for (const auto& [s, part] : verdict.parts) {
    if (!s.is_valid() || !part.error.is_kind_right) continue;
    const RecognisedSurface& record = file.claims.surfaces()[s];
    const double told = std::max(told_deviation(record), verdict.shape.off) + kMaxTruthSteps * file.step;
    if (part.error.distance <= 2 * told && is_right_claim(test::plain(record), face.surface, corners, told))
      sum.evident_right += part.area;
  }
}

/// Returns the largest distance of a free-form face from a surface where the face is claimed for that surface. It is
/// taken at corners, which lie on the face.
double distance_where_claimed(const PolygonMesh& mesh, const StepFace& face, SurfaceId s, const JudgedFile& file,
                              const FinerTessellation* finer) {
  const test::PlainSurface claim = test::plain(file.claims.surfaces()[s]);
  std::vector<PlainTriangle> claimed, others;
  double farthest = 0;
  for (std::uint32_t f = face.first; f < face.first + face.count; ++f) {
    const std::vector<Vec3> c = test::corners_of(mesh, FaceId(f));
    const bool is_claimed = file.claims.surface_of(FaceId(f)) == s;
    (is_claimed ? claimed : others).push_back({c[0], c[1], c[2]});
    if (is_claimed)
      for (const Vec3& p : c) farthest = std::max(farthest, claim.distance(p));
  }
  if (finer == nullptr) return farthest;
  const TriangleBoxes near(claimed), far(others);
  for (const StepFace& same : finer->faces) {
    if (same.number != face.number) continue;
    for (std::uint32_t f = same.first; f < same.first + same.count; ++f)
      for (const Vec3& p : test::corners_of(finer->mesh, FaceId(f)))
        if (near.distance(p) < far.distance(p)) farthest = std::max(farthest, claim.distance(p));
  }
  return farthest;
}

void add_too_far(KindAreas& sum, const FaceVerdict& verdict, const PolygonMesh& mesh, const JudgedFile& file,
                 const FinerTessellation* finer) {
  for (const auto& [s, part] : verdict.parts) {
    if (!s.is_valid() || !is_curved(file.claims.surfaces()[s].shape.kind)) continue;
    const double told = told_deviation(file.claims.surfaces()[s]) + kMaxTruthSteps * file.step;
    if (distance_where_claimed(mesh, *verdict.face, s, file, finer) > told) sum.too_far += part.area;
  }
}

}  // namespace

void KindAreas::add(const KindAreas& other, double whole) {
  faces += other.faces;
  judged_faces += other.judged_faces;
  for (double KindAreas::*const area :
       {&KindAreas::all, &KindAreas::judged, &KindAreas::right, &KindAreas::wrong_kind, &KindAreas::wrong_shape,
        &KindAreas::unclaimed, &KindAreas::claimed, &KindAreas::fitting, &KindAreas::evident, &KindAreas::evident_right,
        &KindAreas::too_far})
    this->*area += other.*area / whole;
}

double surfaces_ms(const Report& report) {
  for (const StageTime& time : report.timing_ms)
    if (time.stage == Stage::kSurfaces) return time.ms;
  return 0;
}

JudgedFile judge(const PolygonMesh& mesh, const std::vector<StepFace>* truth, int runs,
                 const FinerTessellation* finer) {
  JudgedFile file;
  file.step = test::float_step(mesh);
  RunControl control;
  file.claims = test::claims_of(mesh, control);
  double ms = surfaces_ms(file.claims.report);
  for (int run = 1; run < runs; ++run)
    ms = std::min(ms, surfaces_ms(remesh_surface(mesh, unrefined(), {}, control).report));
  file.micros_per_face = 1000 * ms / static_cast<double>(mesh.face_count());
  // A file that holds doubles has a finer step, of which the report tells.
  file.fits = test::fit_of_claims(mesh, file.claims, std::max(file.step, file.claims.report.rounding_step));
  if (truth == nullptr) return file;
  for (const StepFace& face : *truth) {
    if (face.count == 0) continue;
    file.verdicts.push_back(judge_face(mesh, face, file));
    KindAreas& sum = file.kinds[face.surface.kind];
    add_to(sum, file.verdicts.back(), mesh, file);
    if (face.surface.kind == SurfaceKind::kFree)
      add_too_far(sum, file.verdicts.back(), mesh, file, finer);
    else if (face.surface.kind != SurfaceKind::kPlane)
      add_evident(sum, file.verdicts.back(), mesh, file);
  }
  return file;
}

}  // namespace remesh::recognition
