/// Functions that the writers of several formats share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Counts elements, and now and then updates the progress and checks for cancellation.
class WriteProgress {
 public:
  WriteProgress(std::size_t elements, RunControl& control) : elements_(elements), control_(control) {}

  void tick() {
    constexpr std::size_t kStep = 1 << 16;
    if (done_++ % kStep == 0) control_.progress(static_cast<double>(done_ - 1) / static_cast<double>(elements_));
  }

 private:
  std::size_t elements_;
  RunControl& control_;
  std::size_t done_ = 0;
};

/// The part of a stage's progress that one piece of the work takes.
struct ProgressShare {
  double begin, end;
};

/// Appends the texts that `append(text, i)` makes for each i from 0 to n - 1, in that order. Blocks of them are made
/// in parallel on the caller's TBB arena.
/// Errors: kCancelled, kTimeout - through `control`.
template <class Append>
void append_elements(std::string& out, std::size_t n, ProgressShare share, RunControl& control, const Append& append) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t blocks = (n + kBlock - 1) / kBlock;
  const double step = (share.end - share.begin) / static_cast<double>(std::max<std::size_t>(blocks, 1));
  map_in_order<std::string>(
      blocks, control,
      [&](std::size_t block) {
        std::string text;
        for (std::size_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) append(text, i);
        return text;
      },
      [&](std::size_t block, const std::string& text) {
        out += text;
        control.progress(share.begin + step * static_cast<double>(block + 1));
        return true;
      });
}

/// Splits a comment, which may contain line ends, into lines. Control characters become blanks.
std::vector<std::string> comment_lines(std::string_view comment);

/// Replaces all control characters, including line ends, by blanks.
std::string without_control_characters(std::string_view text);

/// Appends a line for each line of the comments: `# ` and its text. Longer lines are folded, because Gmsh takes what is
/// behind the first 255 bytes of a line in Medit's format for another line.
void append_comments(std::string& out, const std::vector<std::string>& comments);

/// Appends the three coordinates with blanks between them.
void append_point(std::string& out, const Vec3& position);
/// Appends the three coordinates, each after a blank, and a line end.
void append_coordinates(std::string& out, const Vec3& position);

/// Appends a line for each vertex, with its coordinates.
/// Input: `share` - see share_of_vertices.
void append_points(std::string& out, const TriangleMesh& mesh, double share, RunControl& control);
/// Appends a line for each face: 3, its vertices from 0 on, and its label of each of the sets.
void append_triangles(std::string& out, const TriangleMesh& mesh, double share,
                      std::span<const LabelSet* const> label_sets, RunControl& control);

/// The share of the progress that the vertices take, if all elements take the same time.
inline double share_of_vertices(const TriangleMesh& mesh) {
  const std::size_t elements = mesh.positions.size() + mesh.faces.size();
  return static_cast<double>(mesh.positions.size()) / static_cast<double>(std::max<std::size_t>(elements, 1));
}

}  // namespace remesh
