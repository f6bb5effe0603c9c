/// Small meshes that tests send to the daemon.
#pragma once

#include <string>

namespace remesh::server {

/// A square of side 8 with a square hole of side 6: area 28, of eight triangles.
inline const std::string kFrame =
    "v -4 -4 1\nv 4 -4 1\nv -4 4 1\nv 4 4 1\nv -3 -3 1\nv 3 -3 1\nv -3 3 1\nv 3 3 1\n"
    "f 5 3 1\nf 4 7 8\nf 1 2 6\nf 5 7 3\nf 1 6 5\nf 6 2 4\nf 4 3 7\nf 8 6 4\n";

/// Makes a bumpy sheet of 2 n² triangles. Hardly two of them are in one plane, so it is work for a while.
inline std::string bumpy_sheet(int n) {
  std::string text;
  unsigned state = 1;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      state = state * 1664525u + 1013904223u;
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " 0." + std::to_string(1000 + (state >> 16) % 9000) +
              "\n";
    }
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x + 1;
      const int b = a + n + 1;
      text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(b + 1) + "\n";
      text += "f " + std::to_string(a) + " " + std::to_string(b + 1) + " " + std::to_string(b) + "\n";
    }
  }
  return text;
}

}  // namespace remesh::server
