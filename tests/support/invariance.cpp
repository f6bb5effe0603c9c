#include "tests/support/invariance.h"

#include <algorithm>

#include "tests/support/shapes.h"

namespace remesh::test {

PolygonMesh Trial::of(const PolygonMesh& mesh) const {
  return shapes::scaled(seed == 0 ? mesh : shapes::renumbered(mesh, seed), scale);
}

void Trial::face(std::vector<Vec3> corners, const std::string& word) {
  for (Vec3& p : corners) p = length(p);
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  piece(corners, word);
}

void Trial::mesh(const TriangleMesh& mesh) {
  for (const Vec3& p : mesh.positions) in_order(length(p));
  for (const Triangle& t : mesh.faces) {
    in_order(t);
    face({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  }
}

std::string Trial::told(Transform transform) const {
  std::string all = same_.str() + '\n';
  if (transform != Transform::kNumbering) all += in_order_.str() + '\n';
  for (const std::string& piece : pieces_) all += piece + '\n';
  return all;
}

std::vector<TestedStage>& stages() {
  static std::vector<TestedStage> all;
  return all;
}

}  // namespace remesh::test
