#include "tests/recognition/judged_file.h"

#include <algorithm>
#include <cmath>

#include "core/remesh.h"

namespace remesh::recognition {
namespace {

constexpr double kMaxOffSteps = 6;
constexpr std::size_t kMinFacets = 4;

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

}  // namespace

double surfaces_ms(const Report& report) {
  for (const StageTime& time : report.timing_ms)
    if (time.stage == Stage::kSurfaces) return time.ms;
  return 0;
}

JudgedFile judge(const PolygonMesh& mesh, const std::vector<StepFace>* truth, int runs) {
  JudgedFile file;
  file.step = test::float_step(mesh);
  RunControl control;
  file.claims = test::claims_of(mesh, control);
  double ms = surfaces_ms(file.claims.report);
  for (int run = 1; run < runs; ++run) ms = std::min(ms, surfaces_ms(analyze_surface(mesh, {}, {}, control)));
  file.micros_per_face = 1000 * ms / static_cast<double>(mesh.face_count());
  // A file that holds doubles has a finer step, of which the report tells.
  file.fits = test::fit_of_claims(mesh, file.claims, std::max(file.step, file.claims.report.rounding_step));
  if (truth == nullptr) return file;
  for (const StepFace& face : *truth) {
    if (face.count == 0) continue;
    file.verdicts.push_back(judge_face(mesh, face, file));
    add_to(file.kinds[face.surface.kind], file.verdicts.back(), mesh, file);
  }
  return file;
}

}  // namespace remesh::recognition
