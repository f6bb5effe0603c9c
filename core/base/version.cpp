#include "core/base/version.h"

namespace remesh {

const char* version() { return REMESHD_VERSION; }

}  // namespace remesh
