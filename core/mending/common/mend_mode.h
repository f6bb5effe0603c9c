/// Says whether defects that are found are also mended.
#pragma once

namespace remesh {

enum class MendMode { kNo, kYes };

/// Converts a flag of the option `repair`.
inline MendMode mend_if(bool is_asked_for) { return is_asked_for ? MendMode::kYes : MendMode::kNo; }

}  // namespace remesh
