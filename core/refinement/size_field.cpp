#include "core/refinement/size_field.h"

namespace remesh {

double SizeField::at(const Vec3&) const { return largest_; }

}  // namespace remesh
