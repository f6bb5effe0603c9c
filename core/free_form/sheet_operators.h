/// Changes a part of a sheet, one place after the other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/free_form/input_surface.h"
#include "core/free_form/quadric.h"
#include "core/free_form/sheet.h"
#include "core/free_form/sheet_trial.h"
#include "core/free_form/witnesses.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A sheet with what its operators have to know of the input.
struct FreeSheet {
  Sheet sheet;
  SheetWitnesses witnesses;
  IdVector<VertexId, Quadric> quadrics;  ///< the planes of the input's faces around each vertex
  IdVector<VertexId, VertexId> source;   ///< the input's vertex at the same place; invalid if there is none
};

/// The rules by which operators decide.
struct SheetRules {
  double tolerance;         ///< how far the sheet and the input may be apart, in the unit of the positions
  double max_cosine;        ///< that of the least angle
  double diagonal;          ///< of the input's box
  std::uint64_t max_steps;  ///< for each part: so many witnesses are looked at, each time that one is
};

/// Changes the part of a sheet whose vertices are numbered from `begin` to `end` - 1. Vertices with a face outside of
/// the part stay. So threads may change different parts at the same time.
/// This class is larger than the bound because all operators share what they know of the part.
class SheetPart {
 public:
  /// Input: `scratch` has a number per corner, which only this part uses at its own corners.
  SheetPart(FreeSheet& free, const InputSurface& input, const SheetRules& rules, VertexId begin, VertexId end,
            std::vector<std::uint32_t>& tried, IdVector<VertexId, std::uint32_t>& changed, const RunControl& control);

  /// Joins vertices with neighbours, those first that cost least, until hardly any more can be joined. Vertices at
  /// planes stay.
  void join_vertices();
  /// Joins vertices at planes with neighbours along the planes' borders. The part is the whole sheet.
  void join_at_planes();
  /// Flips edges and moves vertices where that makes the smallest angles larger.
  void improve_angles();
  /// Does so around some vertices of the part.
  void improve_angles(std::span<const VertexId> vertices);
  std::uint64_t joined() const { return joined_; }
  std::uint64_t steps() const { return trial_.steps(); }

 private:
  struct Candidate {
    double cost;
    std::uint32_t corner;  ///< that from which the edge starts
    friend auto operator<=>(const Candidate&, const Candidate&) = default;
  };

  bool is_work_left() const { return trial_.steps() < rules_.max_steps; }
  bool is_inside(VertexId v) const { return v.value >= begin_.value && v.value < end_.value; }
  bool is_inside(FaceId f) const;
  bool is_movable(VertexId v) const;
  void join(const std::vector<VertexId>& vertices, bool are_at_planes);
  std::vector<Candidate> find_candidates(const std::vector<VertexId>& vertices, bool are_at_planes);
  double cost(const Quadric& quadric, const Vec3& place, VertexId a, VertexId b) const;
  Vec3 joint_place(VertexId a, VertexId b) const;
  bool try_join(std::uint32_t corner);
  bool try_join_free(VertexId from, VertexId to);
  bool try_join_to(VertexId from, VertexId to);
  bool try_join_on_chain(VertexId from, VertexId to);
  void add_star(VertexId v, VertexId other, bool is_other_in);
  bool is_acceptable(Vec3& place, double max_cosine);
  void commit_join(VertexId from, VertexId to, const Vec3& place);
  bool are_chain_witnesses_near(VertexId from, VertexId to, VertexId far) const;
  bool try_flip(std::uint32_t corner);
  bool try_move(VertexId v);
  void record_change(VertexId v);
  void improve_angles_at(VertexId v);

  FreeSheet& free_;
  const SheetRules& rules_;
  VertexId begin_, end_;
  SheetTrial trial_;
  std::vector<std::uint32_t>& tried_;
  IdVector<VertexId, std::uint32_t>& changed_;
  const RunControl& control_;
  std::uint32_t clock_ = 0;
  std::uint64_t joined_ = 0;
};

}  // namespace remesh
