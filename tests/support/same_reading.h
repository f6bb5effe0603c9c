/// Compares the results of two readings.
#pragma once

#include <algorithm>
#include <cstring>

#include "core/io/formats.h"

namespace remesh::test {

/// True if the results are equal, to the last bit of each coordinate.
inline bool is_same_reading(const ReadResult& a, const ReadResult& b) {
  const auto same_bits = [](const Vec3& p, const Vec3& q) { return std::memcmp(&p, &q, sizeof p) == 0; };
  const auto same_diagnostic = [](const Diagnostic& d, const Diagnostic& e) {
    return d.code == e.code && d.count == e.count && d.elements == e.elements && d.message == e.message;
  };
  const PolygonMesh& m = a.mesh;
  const PolygonMesh& n = b.mesh;
  return std::equal(m.positions.begin(), m.positions.end(), n.positions.begin(), n.positions.end(), same_bits) &&
         m.face_begin == n.face_begin && m.corners == n.corners && m.labels == n.labels &&
         std::equal(a.diagnostics.begin(), a.diagnostics.end(), b.diagnostics.begin(), b.diagnostics.end(),
                    same_diagnostic);
}

}  // namespace remesh::test
