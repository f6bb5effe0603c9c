/// Whether what is found wrong is also mended.
#pragma once

namespace remesh {

enum class Mend { kNo, kYes };

/// From one of the options `repair`.
inline Mend mend_if(bool is_asked_for) { return is_asked_for ? Mend::kYes : Mend::kNo; }

}  // namespace remesh
