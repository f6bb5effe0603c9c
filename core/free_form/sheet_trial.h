/// Tests whether new triangles may take the place of others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/stoppable.h"
#include "core/base/vec.h"
#include "core/free_form/input_surface.h"
#include "core/free_form/sheet.h"
#include "core/free_form/witnesses.h"
#include "core/geometry/triangles/distances.h"

namespace remesh {

/// A triangle is a needle if its smallest angle is below the one with this cosine: 5 degrees.
inline constexpr double kNeedle = 0.9962;

/// Returns the largest cosine of a triangle's angles, which is that of its smallest angle; 1 if it has no area.
double max_cosine(const Corners3& triangle);

/// Returns about how many triangles there are once no angle is below the bound: a narrow one becomes a row of them.
/// Faces whose first corner is invalid do not count.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
double triangles_needed(const IdVector<VertexId, Vec3>& positions, const IdVector<FaceId, Triangle>& faces,
                        double min_angle_deg, const RunControl& control);

/// A change of a sheet that is tried before it is made: some triangles get other corners, and others disappear. One
/// corner of all new triangles is their apex, whose place may be chosen.
class SheetTrial {
 public:
  SheetTrial(const Sheet& sheet, const SheetWitnesses& witnesses, const InputSurface& input, const RunControl& control)
      : sheet_(sheet), witnesses_(witnesses), input_(input), check_(control) {}

  /// Begins another trial.
  void clear();
  /// Adds a triangle that stays, with its corners after the change. The first one is the apex.
  void add_changed(FaceId f, const Corners3& corners);
  /// Adds a triangle that disappears.
  void add_removed(FaceId f) {
    if (sheet_.is_of_plane[f] == 0) add(f);
  }

  /// Moves the apex.
  /// Output: whether there are new triangles, none has an angle with a larger cosine than this, and all of them look to
  ///         the side to which the triangles looked before. Triangles of planes only have to stay apart.
  bool has_good_shapes(const Vec3& apex, double max_cosine);
  /// Finds a new triangle for each witness of the triangles.
  /// Output: whether each of them is within the tolerance.
  bool finds_witnesses(double tolerance);
  /// Returns the sum of the new triangles' normals, with the length 1.
  Vec3 direction() const { return direction_; }
  /// Returns whether a step of the apex in that direction may bring all witnesses within the tolerance, as far as is
  /// known after finds_witnesses.
  bool has_better_step() const { return min_step_ <= max_step_; }
  double better_step() const { return (min_step_ + max_step_) / 2; }
  /// Returns whether samples of the new triangles are near the input.
  bool is_near_input(double tolerance) const;
  /// Gives the witnesses to the triangles that were found for them.
  void move_witnesses(SheetWitnesses& witnesses) const;

  /// Returns the largest cosine of the triangles' angles before the change.
  double cosine_before() const { return cosine_before_; }
  /// Returns the largest cosine of the triangles' angles after the change.
  double cosine_after() const { return cosine_after_; }
  /// Returns how many witnesses were looked at.
  std::uint64_t steps() const { return steps_; }

 private:
  struct Changed {
    FaceId face;
    Corners3 corners;
    Vec3 normal_before;
    Vec3 normal, second, third;  ///< the unit normal, and the vectors whose products give barycentric coordinates
    FaceId start;                ///< the face of the witness that is nearest to the centroid
    double start_distance;       ///< the square of its distance
  };
  struct Found {
    Vec3 place;
    std::uint32_t witness;
    std::uint32_t changed;
    FaceId face;
    double share;  ///< the share of the tolerance that counts at the witness
  };

  /// A triangle of a plane with its corners after the change. The first one is the apex.
  struct InPlane {
    Corners3 corners;
    int axis;              ///< the one along which the plane is seen
    bool is_turned;        ///< whether the triangle is seen from behind
    double cosine_before;  ///< the largest of its angles' cosines
  };

  void add(FaceId f);
  static bool stays_in_plane(const InPlane& triangle);
  void gather();
  bool find(Found& witness, std::size_t first, double tolerance);
  void bound_step(double distance, double share, double tolerance);

  const Sheet& sheet_;
  const SheetWitnesses& witnesses_;
  const InputSurface& input_;
  StopCheck check_;
  std::vector<FaceId> faces_;  ///< those that change or disappear
  std::vector<Changed> changed_;
  std::vector<InPlane> in_plane_;
  std::vector<Found> found_;  ///< empty until witnesses are needed
  double cosine_before_ = -1, cosine_after_ = -1;
  Vec3 direction_;
  double min_step_ = 0, max_step_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace remesh
