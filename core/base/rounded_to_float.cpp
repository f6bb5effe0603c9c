#include "core/base/rounded_to_float.h"

namespace remesh {

[[gnu::noinline]] double rounded_to_float(double value) { return static_cast<float>(value); }

}  // namespace remesh
