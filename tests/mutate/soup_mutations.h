/// Changes to a mesh that keep it a mesh: moved, merged, torn, folded.
#pragma once

#include <string>

#include "tests/mutate/polygon_soup.h"
#include "tests/support/random.h"

namespace remesh::mutate {

/// Changes something, once.
/// Output: the words for what was done.
std::string mutate_soup(PolygonSoup& soup, Random& random);

/// Puts a second mesh beside, into or onto the first, in its size or in its own.
void merge_soup(PolygonSoup& soup, PolygonSoup other, Random& random);

Box3 box_of(const PolygonSoup& soup);

}  // namespace remesh::mutate
