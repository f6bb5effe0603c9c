/// Changes a mesh such that it remains a mesh: it is moved, merged, torn, folded.
#pragma once

#include <string>

#include "tests/mutate/polygon_soup.h"
#include "tests/support/random.h"

namespace remesh::mutate {

/// Makes one change.
/// Output: a description of the change.
std::string mutate_soup(PolygonSoup& soup, Random& random);

/// Puts a second mesh beside, into or onto the first, scaled to its size or in its own size.
void merge_soup(PolygonSoup& soup, PolygonSoup other, Random& random);

Box3 box_of(const PolygonSoup& soup);

}  // namespace remesh::mutate
