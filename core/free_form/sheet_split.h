/// Makes a sheet finer where it is not good enough.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/free_form/input_surface.h"
#include "core/free_form/sheet_operators.h"
#include "core/free_form/sheet_trial.h"

namespace remesh {

/// Moves vertices of a sheet back to the input, and splits edges at places of the input. The topology stays.
class SheetSplitter {
 public:
  SheetSplitter(FreeSheet& free, const InputSurface& input, const RunControl& control)
      : free_(free), input_(input), trial_(free.sheet, free.witnesses, input, control), control_(control) {}

  /// The place at which an edge is split that is no chain edge.
  enum class Place : std::uint8_t {
    kMiddle,  ///< the middle of the edge
    kInput    ///< the place of the input that is nearest to the middle, or the middle if that place makes needles
  };

  /// Moves the vertices of faces to the nearest places of the input, if no triangle is turned over by that.
  /// Output: whether any was moved.
  bool move_to_input(std::span<const FaceId> faces);
  /// Splits the longest edge of each face that can be split.
  /// Input:  faces that are there, ascending.
  /// Output: the vertices that the faces had and have, ascending.
  std::vector<VertexId> split(std::span<const FaceId> faces, Place place);

 private:
  bool move_to_input(VertexId v);
  bool split(std::uint32_t corner, Place place);
  bool is_split_possible(VertexId v, VertexId w, const Vec3& place, double max_cosine);
  FaceId start_near(std::initializer_list<VertexId> vertices, const Vec3& place) const;
  std::uint32_t near_witness(std::uint32_t chain, const Vec3& place) const;
  void divide_chain(std::uint32_t chain, std::uint32_t middle, VertexId v, VertexId w, std::uint32_t far_chain);
  void share_witnesses(std::span<const FaceId> old_faces, std::span<const FaceId> faces);

  FreeSheet& free_;
  const InputSurface& input_;
  SheetTrial trial_;
  const RunControl& control_;
};

}  // namespace remesh
