/// A table of stages, and the transforms of the input under which the results of each stage stay the same.
///
/// The file that tests a stage adds the stage's row to the table, since the row needs the same inputs as the other
/// tests of the stage. The suite `invariance` (tests/core/invariance_test.cpp) tries each row with each transform that
/// the row names.
#pragma once

#include <cstdio>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh::test {

enum class Transform {
  kWorkers,       ///< two and eight threads instead of one
  kScale,         ///< the input times powers of two
  kExtremeScale,  ///< the input times 2^-300 and 2^300
  kNumbering,     ///< vertices and faces in another order
  kStop,          ///< a stop that was asked for before the stage began
};
using enum Transform;

/// One run of a stage. The row takes its input through the trial, and tells the trial what the stage has made of it.
class Trial {
 public:
  double scale = 1;
  unsigned seed = 0;  ///< of the new numbers of vertices and faces; 0 leaves them as they are
  int workers = 1;
  RunControl control;  ///< of the stage alone; what comes before the stage has a control of its own

  /// Returns the mesh, scaled and renumbered as the trial asks.
  PolygonMesh of(const PolygonMesh& mesh) const;

  /// Returns a length, or a place, of the result as it would be without the scaling.
  double length(double x) const { return x / scale; }
  Vec2 length(Vec2 x) const { return (1 / scale) * x; }
  Vec3 length(const Vec3& x) const { return (1 / scale) * x; }

  /// Tells values that no transform may change.
  template <class... Values>
  void same(const Values&... values) {
    (print(same_, values), ...);
  }
  /// Tells values that no transform but new numbers may change.
  template <class... Values>
  void in_order(const Values&... values) {
    (print(in_order_, values), ...);
  }
  /// Tells a part of the result, whose place among the other parts does not matter.
  template <class... Values>
  void piece(const Values&... values) {
    std::ostringstream text;
    (print(text, values), ...);
    pieces_.insert(text.str());
  }
  /// Tells a polygon by the places of its corners, in model units, and a word about it. It does not matter which corner
  /// is the first.
  void face(std::vector<Vec3> corners, const std::string& word = {});
  /// Tells a mesh: the faces by their places, and the numbers in their order.
  void mesh(const TriangleMesh& mesh);

  /// Returns all that was told and must be the same after the transform.
  std::string told(Transform transform) const;

 private:
  void print(std::ostringstream& out, double x) const {
    char text[32];
    std::snprintf(text, sizeof text, "%a ", x);
    out << text;
  }
  void print(std::ostringstream& out, Vec2 p) const { print(out, std::pair(p.x, p.y)); }
  void print(std::ostringstream& out, const Vec3& p) const { print(out, std::pair(Vec2{p.x, p.y}, p.z)); }
  template <class A, class B>
  void print(std::ostringstream& out, const std::pair<A, B>& pair) const {
    print(out, pair.first);
    print(out, pair.second);
  }
  template <class Value>
  void print(std::ostringstream& out, const Value& value) const {
    if constexpr (requires { out << value; }) {
      out << value << ' ';
    } else {
      for (const auto& item : value) print(out, item);
      out << '\n';
    }
  }

  std::ostringstream same_, in_order_;
  std::multiset<std::string> pieces_;
};

struct TestedStage {
  std::string name;
  std::vector<Transform> transforms;
  void (*run)(Trial&);
};

/// The table. Rows come in while the program starts.
std::vector<TestedStage>& stages();

/// Adds a row to the table.
struct Row {
  explicit Row(TestedStage stage) { stages().push_back(std::move(stage)); }
};

}  // namespace remesh::test

/// Adds a stage to the table. What stands behind it in braces is one run: `STAGE(weld, test::kScale) { ... }`.
#define STAGE(name, ...)                                             \
  void run_##name(test::Trial& trial);                               \
  const test::Row row_of_##name{{#name, {__VA_ARGS__}, run_##name}}; \
  void run_##name(test::Trial& trial)
