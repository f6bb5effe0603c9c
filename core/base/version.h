/// The version of the project.
#pragma once

namespace remesh {

/// The version as it is shown in the report and by `--version`.
const char* version();

}  // namespace remesh
