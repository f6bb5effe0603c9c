#include "core/patches/charts/curved_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "tests/support/errors.h"
#include "tests/support/primitives.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using primitives::Model;

AnalyticSurface shape_of(const test::PlainSurface& s) {
  const Vec3 axis = norm(s.axis) > 0 ? normalized(s.axis) : Vec3{};
  return {s.kind, s.point, axis, s.radius, s.tube, s.half_deg * std::numbers::pi / 180};
}

/// The facets of a model with the truth about their surfaces, and what they were joined to.
class Joined {
 public:
  /// Input: `marked` - faces of the input that have that rung.
  explicit Joined(const Model& model, double feature_angle_deg = 30, const std::vector<std::size_t>& marked = {},
                  CurvedRung rung = CurvedRung::kFacet)
      : model_(model), chain_(model_.mesh) {
    for (const test::PlainSurface& s : model.surfaces) {
      RecognisedSurface surface;
      surface.shape = shape_of(s);
      recognised_.surfaces.push_back(surface);
      limits_.push_back({SurfaceMap::can_map(surface.shape) ? 0.1 : 0, 0.1, 0.5, 0.1});
    }
    recognised_.of_patch.resize(chain_.patches.count());
    for (std::size_t f = 0; f < model.mesh.face_count(); ++f)
      recognised_.of_patch[chain_.patch_of(f)] = SurfaceId(model.surface_of[FaceId(f)]);
    if (!marked.empty()) rungs_.resize(chain_.surface.face_count(), CurvedRung::kJoined);
    for (const std::size_t f : marked)
      for (std::size_t g = 0; g < chain_.surface.face_count(); ++g)
        if (chain_.surface.face_source[FaceId(g)].value == f) rungs_[FaceId(g)] = rung;
    join(feature_angle_deg);
  }

  void join(double feature_angle_deg) {
    result_ = join_curved_facets(chain_.surface, chain_.adjacency, chain_.patches, recognised_, feature_angle_deg,
                                 limits_, rungs_, chain_.control);
  }
  std::vector<CurvedLimits>& limits() { return limits_; }
  StageChain& chain() { return chain_; }
  const CurvedPatches& result() const { return result_; }
  std::size_t curved() const { return result_.curved.size(); }
  std::size_t planar() const {
    return (result_.has_any() ? result_.patches.count() : chain_.patches.count()) - curved();
  }
  PatchId patch_of(std::size_t input_face) const {
    return result_.patches.of_face[chain_.patches.faces_of(chain_.patch_of(input_face)).front()];
  }
  /// The faces of the surface in each curved patch, in the patches' order.
  std::vector<std::size_t> sizes() const {
    std::vector<std::size_t> all;
    for (std::uint32_t p = 0; p < result_.patches.count(); ++p)
      if (result_.of(PatchId(p)) != nullptr) all.push_back(result_.patches.faces_of(PatchId(p)).size());
    return all;
  }

  /// Tests what holds for any result.
  void expect_holds() const {
    SCOPED_TRACE(model_.name);
    const PatchSet& set = result_.patches;
    ASSERT_TRUE(result_.has_any());
    ASSERT_EQ(set.of_face.size(), chain_.surface.face_count());
    ASSERT_EQ(result_.at.size(), set.count());
    ASSERT_EQ(result_.surfaces.of_patch.size(), set.count());
    std::uint32_t first_before = 0, curved = 0;
    for (std::uint32_t i = 0; i < set.count(); ++i) {
      const PatchId p(i);
      const auto faces = set.faces_of(p);
      ASSERT_FALSE(faces.empty());
      EXPECT_TRUE(std::is_sorted(faces.begin(), faces.end()));
      if (i > 0) {
        EXPECT_GT(faces.front().value, first_before) << "numbered by the first face";
      }
      first_before = faces.front().value;
      for (const FaceId f : faces) {
        EXPECT_EQ(set.of_face[f], p);
        EXPECT_EQ(result_.surfaces.of_patch[p], recognised_.of_patch[chain_.patches.of_face[f]]);
      }
      if (const CurvedPatch* patch = result_.of(p)) {
        EXPECT_EQ(patch, &result_.curved[curved++]) << "in the order of their patches";
        EXPECT_EQ(patch->surface, result_.surfaces.of_patch[p]);
        EXPECT_EQ(patch->limits.tolerance, limits_[patch->surface.value].tolerance);
        expect_mapped(p, *patch);
      } else {
        // A planar patch is one facet, unchanged.
        const PatchId facet = chain_.patches.of_face[faces.front()];
        EXPECT_EQ(chain_.patches.faces_of(facet).size(), faces.size());
        EXPECT_EQ(set.planes[p].normal, chain_.patches.planes[facet].normal);
      }
    }
    EXPECT_EQ(curved, result_.curved.size());
    std::map<std::uint32_t, std::uint64_t> count;
    for (const SurfaceId s : result_.surfaces.of_patch) ++count[s.value];
    for (std::uint32_t s = 0; s < result_.surfaces.surfaces.size(); ++s)
      EXPECT_EQ(result_.surfaces.surfaces[SurfaceId(s)].patches, count[s]);
  }

 private:
  /// The faces of a patch hang together and lie in the plane of their map counter-clockwise and side by side: no
  /// vertex lies inside another face.
  void expect_mapped(PatchId p, const CurvedPatch& patch) const {
    const auto faces = result_.patches.faces_of(p);
    std::vector<std::vector<Vec2>> flat;
    std::map<std::pair<VertexId, VertexId>, std::size_t> at;
    double area = 0, in_space = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const auto face = chain_.surface.face(faces[i]);
      std::vector<Vec2> places;
      Vec3 twice;
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Vec3& position = chain_.surface.positions[face[k]];
        places.push_back(patch.map.flat(position));
        at[{face[k], face[(k + 1) % face.size()]}] = i;
        twice += cross(position, chain_.surface.positions[face[(k + 1) % face.size()]]);
      }
      double twice_flat = 0;
      for (std::size_t k = 0; k < places.size(); ++k) twice_flat += cross(places[k], places[(k + 1) % places.size()]);
      EXPECT_GT(twice_flat, 0);
      area += twice_flat / 2;
      in_space += norm(twice) / 2;
      flat.push_back(places);
    }
    EXPECT_EQ(sheets(faces.size(), at), 1u) << "the faces hang together";
    if (patch.map.shape().kind == SurfaceKind::kCylinder || patch.map.shape().kind == SurfaceKind::kCone) {
      EXPECT_NEAR(area, in_space, 0.05 * in_space);
    }
    for (const std::vector<Vec2>& a : flat)
      for (const std::vector<Vec2>& b : flat) {
        if (&a == &b) continue;
        Vec2 middle{0, 0};
        for (const Vec2 q : a) middle = middle + (1.0 / static_cast<double>(a.size())) * q;
        bool is_inside = true;
        for (std::size_t k = 0; k < b.size(); ++k)
          is_inside = is_inside && cross(b[(k + 1) % b.size()] - b[k], middle - b[k]) > 0;
        EXPECT_FALSE(is_inside) << "two faces lie on each other";
      }
  }
  static std::size_t sheets(std::size_t faces, const std::map<std::pair<VertexId, VertexId>, std::size_t>& at) {
    std::vector<std::size_t> sheet(faces);
    for (std::size_t i = 0; i < faces; ++i) sheet[i] = i;
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      for (const auto& [edge, f] : at) {
        const auto other = at.find({edge.second, edge.first});
        if (other == at.end() || sheet[other->second] == sheet[f]) continue;
        sheet[f] = sheet[other->second] = std::min(sheet[f], sheet[other->second]);
        is_changed = true;
      }
    }
    return std::set<std::size_t>(sheet.begin(), sheet.end()).size();
  }

  Model model_;
  StageChain chain_;
  RecognisedSurfaces recognised_;
  std::vector<CurvedLimits> limits_;
  IdVector<FaceId, CurvedRung> rungs_;
  CurvedPatches result_;
};

TEST(curved_patches, a_closed_cylinder_is_two_halves) {
  for (const int n : {13, 16, 24, 72}) {
    const Joined joined(primitives::cylinder(n, 10, 30));
    joined.expect_holds();
    EXPECT_EQ(joined.curved(), 2u) << n;
    EXPECT_EQ(joined.planar(), 2u) << n;
    const std::vector<std::size_t> sizes = joined.sizes();
    ASSERT_EQ(sizes.size(), 2u);
    EXPECT_LE(std::max(sizes[0], sizes[1]) - std::min(sizes[0], sizes[1]), n % 2 == 0 ? 0u : 1u) << n;
  }
}

TEST(curved_patches, rows_of_facets_join_too) {
  const Joined joined(primitives::cylinder(24, 10, 30, 4));
  joined.expect_holds();
  EXPECT_EQ(joined.curved(), 2u);
}

TEST(curved_patches, a_part_of_a_cylinder_is_one_patch_unless_its_ends_are_near_each_other) {
  // The map is cut open where at least a sixth of a turn is free.
  for (const int count : {2, 6, 12, 19, 21, 23}) {
    const Joined joined(primitives::arc(24, count, 3, 2));
    joined.expect_holds();
    EXPECT_EQ(joined.curved(), count < 20 ? 1u : 2u) << count;
    EXPECT_EQ(joined.planar(), 0u) << count;
  }
}

TEST(curved_patches, a_cone_with_its_apex_and_a_frustum_are_two_halves_each) {
  for (const Model& model : {primitives::cone(24, 4, 7), primitives::frustum(24, 4, 1, 7)}) {
    const Joined joined(model);
    joined.expect_holds();
    EXPECT_EQ(joined.curved(), 2u) << model.name;
  }
}

TEST(curved_patches, a_ball_is_two_hemispheres_and_a_torus_four_pieces) {
  for (const Model& model : {primitives::globe(24, 12, 3), primitives::icosphere(2, 3)}) {
    const Joined ball(model);
    ball.expect_holds();
    EXPECT_EQ(ball.curved(), 2u) << model.name;
    EXPECT_EQ(ball.planar(), 0u) << model.name;
  }
  const Joined ring(primitives::torus(36, 36, 16, 5, 2));
  ring.expect_holds();
  EXPECT_EQ(ring.curved(), 4u);
  const Joined elbow(primitives::torus(36, 9, 16, 5, 2));
  elbow.expect_holds();
  EXPECT_EQ(elbow.curved(), 2u) << "it is closed around the tube alone";
}

/// Returns whether all faces of a patch are on the same side of the plane z = 0 of the model as it was made.
bool are_sides_apart(const Model& made, const Joined& joined) {
  std::map<PatchId, int> side_of;
  for (std::size_t f = 0; f < made.mesh.face_count(); ++f) {
    Vec3 sum;
    for (const VertexId v : made.mesh.face(FaceId(f))) sum += made.mesh.positions[v];
    const int side = sum.z > 0 ? 1 : -1;
    if (side_of.emplace(joined.patch_of(f), side).first->second != side) return false;
  }
  return true;
}

TEST(curved_patches, sheets_are_divided_alike_however_a_model_is_turned) {
  // Balls and rings are divided where they are symmetric.
  for (const Model& model :
       {primitives::globe(24, 12, 3), primitives::torus(36, 36, 16, 5, 2), primitives::torus(36, 9, 16, 5, 2),
        primitives::frustum(24, 4, 1, 7), primitives::cone(24, 4, 7), primitives::cylinder(24, 10, 30)})
    for (const primitives::Variant& variant : primitives::variants()) {
      SCOPED_TRACE(model.name + ", " + variant.name);
      if (variant.storage != primitives::Storage::kDoubles) continue;
      const Joined joined(primitives::varied(model, variant, nullptr));
      joined.expect_holds();
      const std::vector<std::size_t> sizes = joined.sizes();
      for (const std::size_t size : sizes) EXPECT_EQ(size, sizes.front());
      if (model.surfaces.size() == 1) {
        EXPECT_TRUE(are_sides_apart(model, joined));
      }
    }
}

TEST(curved_patches, a_flat_ring_around_a_torus_stays_a_facet_and_the_rest_is_joined) {
  const Joined joined(primitives::torus_with_flat_rings(48, 24, 5, 2));
  joined.expect_holds();
  EXPECT_EQ(joined.curved(), 4u) << "two halves outside of the rings and two inside";
  EXPECT_EQ(joined.planar(), 2u);
}

TEST(curved_patches, pieces_of_fillets_are_one_patch_each) {
  const Joined joined(primitives::rounded_box({4, 3, 2}, 1, 6));
  joined.expect_holds();
  EXPECT_EQ(joined.curved(), 20u) << "12 edges and 8 corners";
  EXPECT_EQ(joined.planar(), 6u);
}

TEST(curved_patches, the_facets_of_a_hole_look_to_the_axis) {
  const Joined tube(primitives::tube(24, 5, 1, 8));
  tube.expect_holds();
  EXPECT_EQ(tube.curved(), 4u);
  for (const CurvedPatch& patch : tube.result().curved)
    EXPECT_EQ(patch.map.side(), patch.map.shape().radius == 5 ? 1 : -1);
}

TEST(curved_patches, a_strip_around_a_screw_is_cut_at_every_half_turn) {
  const int turns = 5;
  const Joined screw(primitives::thread(48, turns));
  screw.expect_holds();
  // Crest and root run around five times.
  EXPECT_EQ(screw.curved(), 2u * 2 * turns);
  for (const std::size_t size : screw.sizes()) EXPECT_EQ(size, 48u) << "24 facets of two triangles";
}

TEST(curved_patches, shafts_of_one_surface_that_do_not_touch_stay_apart) {
  const Joined plates(primitives::plates_with_a_common_bore(24));
  plates.expect_holds();
  // Two halves of each bore, and of each plate's rim.
  EXPECT_EQ(plates.curved(), 8u);
  // A pin in its bore has the same surface, and looks the other way.
  const Joined pin(primitives::pin_in_its_bore(24));
  pin.expect_holds();
  EXPECT_EQ(pin.curved(), 6u);
}

TEST(curved_patches, labels_are_barriers) {
  Model model = primitives::arc(24, 12, 3, 2);
  model.mesh = with_groups(model.mesh, {0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 3});
  const Joined joined(model);
  joined.expect_holds();
  EXPECT_EQ(joined.sizes(), (std::vector<std::size_t>{4, 5, 2}));
  EXPECT_EQ(joined.planar(), 1u) << "nothing joins a single facet";
}

TEST(curved_patches, only_smooth_edges_join) {
  const Model model = primitives::arc(24, 12, 3, 2);
  EXPECT_EQ(Joined(model, 16).curved(), 1u);
  EXPECT_EQ(Joined(model, 14).curved(), 0u);
  EXPECT_FALSE(Joined(model, 0).result().has_any());
}

TEST(curved_patches, faces_on_the_last_rung_stay_facets) {
  const Model model = primitives::arc(24, 12, 3, 2);
  const Joined joined(model, 30, {5});
  joined.expect_holds();
  EXPECT_EQ(joined.sizes(), (std::vector<std::size_t>{5, 6}));
  EXPECT_EQ(joined.planar(), 1u);
  EXPECT_EQ(joined.result().of(joined.patch_of(5)), nullptr);
  EXPECT_NE(joined.patch_of(4), joined.patch_of(6));
  EXPECT_FALSE(Joined(model, 30, {1, 3, 5, 7, 9, 11}).result().has_any()) << "no two neighbours are left";
}

TEST(curved_patches, the_finest_limits_among_its_faces_hold_for_a_patch) {
  const Joined joined(primitives::tube(24, 5, 1, 8), 30, {3}, CurvedRung::kTightened);
  joined.expect_holds();
  EXPECT_EQ(joined.curved(), 4u);
  std::size_t finer = 0;
  for (const CurvedPatch& patch : joined.result().curved) {
    EXPECT_EQ(patch.limits.tolerance, 0.1);
    if (patch.limits.max_height < 0.1) {
      ++finer;
      EXPECT_GT(patch.limits.max_height, 0);
      EXPECT_LE(patch.limits.boundary_tolerance, 0.1);
    }
  }
  EXPECT_EQ(finer, 1u);
  EXPECT_LT(joined.result().of(joined.patch_of(3))->limits.max_height, 0.1);
}

TEST(curved_patches, a_surface_without_a_tolerance_keeps_its_facets) {
  Joined joined(primitives::tube(24, 5, 1, 8));
  for (CurvedLimits& limits : joined.limits())
    if (limits.tolerance > 0) {
      limits.tolerance = 0;
      break;
    }
  joined.join(30);
  joined.expect_holds();
  EXPECT_EQ(joined.curved(), 2u);
  EXPECT_EQ(joined.planar(), 2u + 24u);
}

TEST(curved_patches, planes_alone_join_nothing) { EXPECT_FALSE(Joined(primitives::nut(6, 0)).result().has_any()); }

TEST(curved_patches, numbers_of_faces_and_vertices_do_not_matter) {
  const auto sets_of = [](const Joined& joined, const PolygonMesh& mesh) {
    std::map<PatchId, std::set<std::set<Vec3>>> sets;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      std::set<Vec3> corners;
      for (const VertexId v : mesh.face(FaceId(f))) corners.insert(mesh.positions[v]);
      sets[joined.patch_of(f)].insert(corners);
    }
    std::set<std::set<std::set<Vec3>>> all;
    for (const auto& [patch, faces] : sets) all.insert(faces);
    return all;
  };
  for (const Model& model : {primitives::torus(24, 24, 12, 5, 2), primitives::globe(24, 12, 3),
                             primitives::cylinder(17, 10, 30, 3), primitives::tee(24)}) {
    const Joined joined(model);
    for (const unsigned seed : {1u, 2u}) {
      // The faces of the renumbered mesh find their surface by their corners.
      Model other = model;
      other.mesh = shapes::renumbered(model.mesh, seed);
      std::map<std::set<Vec3>, std::uint32_t> surface_of;
      const auto corners_of = [](const PolygonMesh& mesh, std::size_t f) {
        std::set<Vec3> corners;
        for (const VertexId v : mesh.face(FaceId(f))) corners.insert(mesh.positions[v]);
        return corners;
      };
      for (std::size_t f = 0; f < model.mesh.face_count(); ++f)
        surface_of[corners_of(model.mesh, f)] = model.surface_of[FaceId(f)];
      for (std::size_t f = 0; f < model.mesh.face_count(); ++f)
        other.surface_of[FaceId(f)] = surface_of.at(corners_of(other.mesh, f));
      EXPECT_EQ(sets_of(Joined(other), other.mesh), sets_of(joined, model.mesh)) << model.name << " " << seed;
    }
  }
}

TEST(curved_patches, a_stop_is_obeyed) {
  Joined joined(primitives::cylinder(72, 10, 30));
  joined.chain().control.cancel();
  EXPECT_EQ(test::error_of([&] { joined.join(30); }).code, Code::kCancelled);
}

}  // namespace
}  // namespace remesh
