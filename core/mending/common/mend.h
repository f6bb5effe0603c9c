/// Says whether defects that are found are also mended.
#pragma once

namespace remesh {

enum class Mend { kNo, kYes };

/// Converts a flag of the option `repair`.
inline Mend mend_if(bool is_asked_for) { return is_asked_for ? Mend::kYes : Mend::kNo; }

}  // namespace remesh
