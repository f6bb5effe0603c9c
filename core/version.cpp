#include "core/remesh.h"

namespace remesh {

const char* version() { return REMESHD_VERSION; }

}  // namespace remesh
