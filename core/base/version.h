/// The version of the project.
#pragma once

namespace remesh {

/// As in the report and in `--version`.
const char* version();

}  // namespace remesh
