/// Judges what a run claims of a drawn solid and what it made of the solid, by geometry alone.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "tests/recognition/drawn_solid.h"

namespace remesh::recognition {

/// Numbers of true surfaces of one name.
struct DrawnCounts {
  std::size_t surfaces = 0;
  std::size_t found = 0;   ///< one claim of the right kind and radii has nearly all of the area
  std::size_t missed = 0;  ///< neither found nor wrong; for surfaces without a kind, and planes, left as they are
  std::size_t wrong = 0;   ///< claimed as a kind that it does not have, farther away than the claim tells
  std::size_t off = 0;     ///< the kind is right, but not a radius, or the place by more than the claim tells

  void add(const DrawnCounts& other);
};

struct DrawnVerdict {
  std::map<std::string, DrawnCounts> by_name;
  std::size_t remeshed = 0;  ///< recognised surfaces of which a patch may have moved
  /// Surfaces that are farther from the other mesh than their record tells, and whether the whole result is.
  std::size_t moved = 0;
  /// True surfaces of which input and result are farther apart than the input's own chords, those of the number of
  /// elements that is asked for, and what was put off the surface explain.
  std::size_t unexplained = 0;
  bool is_volume_right = true;
  std::string error;                ///< the run has failed
  std::vector<std::string> faults;  ///< what is not right, as sentences
};

/// Runs the pipeline and judges the result.
DrawnVerdict judge_solid(const DrawnSolid& solid, const Options& options);

/// The options of the preset for volume meshing.
Options volume_options();
Options circle_options(double elements_per_circle);

}  // namespace remesh::recognition
