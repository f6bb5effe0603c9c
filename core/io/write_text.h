/// What the writers of several formats share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// Calls for a look at the control once an element; looks now and then.
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

/// The lines of a comment, which may hold line ends; control characters become blanks.
std::vector<std::string> comment_lines(std::string_view comment);

/// Text with its control characters, line ends among them, made blanks.
std::string without_control_characters(std::string_view text);

/// Appends the three coordinates, a blank before each, and a line end.
void append_coordinates(std::string& out, const Vec3& position);

}  // namespace remesh
