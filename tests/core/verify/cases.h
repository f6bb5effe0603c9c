/// Correct claims of every kind, with which the tests of the checker begin.
#pragma once

#include <string_view>

#include "tests/core/verify/example.h"
#include "tests/support/shapes.h"

namespace remesh {

inline Example cube() { return example(shapes::box({1, 1, 1}, 4), shapes::box({1, 1, 1}, 1)); }
inline Example ring() { return example(shapes::ring(4), shapes::ring(1)); }

/// Makes the L without the vertices inside its long sides.
inline PolygonMesh minimal_l() {
  return shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}},
                            {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}});
}
inline Example flat_l() { return example(shapes::flat({"#.", "##"}, 3), minimal_l()); }

/// Makes a plate with a slot, of which only the corners of the slot and of the plate are left.
inline Example slotted() {
  const PolygonMesh minimal =
      shapes::from_lists({{0, 0, 0}, {5, 0, 0}, {5, 3, 0}, {3, 3, 0}, {3, 1, 0}, {2, 1, 0}, {2, 3, 0}, {0, 3, 0}},
                         {{0, 1, 4}, {0, 4, 5}, {0, 5, 7}, {5, 6, 7}, {1, 3, 4}, {1, 2, 3}});
  return example(shapes::slotted_plate(2), minimal);
}

/// Makes two squares that meet at right angles in one edge, from x = 0 to 2.
inline Example fold() {
  const auto page = [](int n) {
    return shapes::welded(shapes::joined(
        shapes::sheet(2, 2, n, n), shapes::rotated(shapes::turned_over(shapes::sheet(2, 2, n, n)), {1, 0, 0}, 90)));
  };
  return example(shapes::rounded(page(2), 0.5), shapes::rounded(page(1), 0.5));
}

/// Makes a square whose middle is a vertex of the input, so that the output may use it.
inline Example square_with_middle() {
  const PolygonMesh fan = shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
                                             {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  return example(fan, fan);
}

/// Makes a pyramid whose base loses the vertex in its middle. Its four sides are kept as they are.
inline Example pyramid() {
  const std::vector<Vec3> corners{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 1}};
  const PolygonMesh output =
      shapes::from_lists(corners, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 3, 2}, {0, 2, 1}});
  std::vector<Vec3> with_middle = corners;
  with_middle.push_back({1, 1, 0});
  return example(
      shapes::from_lists(with_middle,
                         {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}}),
      output);
}

/// Makes a square of 4 x 4 cells whose vertex (1, 1) is lifted. In the output four corners are left.
inline Example bump(double height, double plane_tolerance) {
  PolygonMesh input = shapes::sheet(4, 4, 4, 4);
  const PolygonMesh output = shapes::sheet(4, 4, 1, 1);
  Example e = example(input, output);
  e.move([&](Vec3& p) {
    if (p == Vec3{1, 1, 0}) p.z = height;
  });
  e.plane_tolerance = plane_tolerance;
  return e;
}

/// Makes a slope of 1 : 2000 in a frame that calls it level. Thus heights over the plane go up to four tolerances, and
/// say nothing. The vertex (1, 1) is lifted off the slope.
inline Example slope(double lift) {
  const auto tilted = [](PolygonMesh mesh) {
    for (Vec3& p : mesh.positions) p.z = 0.5e-3 * p.x;
    return mesh;
  };
  Example e = example(tilted(shapes::flat({"####", "#.##", "####", "####"}, 3)),
                      tilted(shapes::flat({"####", "#.##", "####", "####"})));
  e.move([&](Vec3& p) {
    if (p == Vec3{1 / 3.0, 2 / 3.0, 0.5e-3 / 3}) p.z += lift;
  });
  e.frames[PatchId(0)] = {{2, 2, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 4, 0x1p-40};
  e.project();
  e.make_delaunay();
  e.plane_tolerance = 0.5e-3;
  return e;
}

}  // namespace remesh
