/// The answer that the programs around other libraries print. The scripts read it.
#pragma once

#include <cstddef>
#include <cstdio>

namespace remesh::bench {

struct PeerAnswer {
  double read_ms = 0;
  double process_ms = 0;
  double write_ms = 0;
  std::size_t faces_in = 0;
  std::size_t faces_out = 0;

  /// Prints the answer as one JSON object.
  void print() const {
    std::printf(R"({"read_ms": %.3f, "process_ms": %.3f, "write_ms": %.3f, "faces_in": %zu, "faces_out": %zu})"
                "\n",
                read_ms, process_ms, write_ms, faces_in, faces_out);
  }
};

}  // namespace remesh::bench
