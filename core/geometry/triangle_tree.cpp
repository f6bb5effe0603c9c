#include "core/geometry/triangle_tree.h"

#include <algorithm>
#include <utility>

#include "core/base/blocks.h"

namespace remesh {
namespace {

/// A triangle on its way to its slot.
struct Item {
  Vec3 centre;  ///< of its box, twice: no rounding more than needed
  FaceId face;
};

Box3 box_of(const Triangle& face, std::span<const Vec3> positions) {
  Box3 box;
  for (const VertexId v : face) box.add(positions[v.value]);
  return box;
}

int longest_axis(const Box3& box) {
  const Vec3 extent = box.max - box.min;
  return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
}

/// Parts the items so that all before `middle` are, along the longest axis, before all from there on.
void split(std::span<Item> items, std::size_t middle, RunControl& control) {
  control.check();
  Box3 centres;
  for (const Item& item : items) centres.add(item.centre);
  const int axis = longest_axis(centres);
  std::uint32_t comparisons = 0;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [&](const Item& a, const Item& b) {
                     if (++comparisons % (1u << 16) == 0) control.check();
                     const double a_place = a.centre[axis], b_place = b.centre[axis];
                     return a_place != b_place ? a_place < b_place : a.face < b.face;
                   });
}

constexpr std::size_t kBlock = 4096;

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> faces, RunControl& control)
    : face_(faces.size()), slot_box_(faces.size()) {
  if (faces.empty()) {
    node_box_.assign(1, Box3());
    return;
  }
  while (size() > kLeafSize << leaf_level_) ++leaf_level_;

  std::vector<Item, LeftUnset<Item>> items(size());
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Box3 box = box_of(faces[f], positions);
      items[f] = {box.min + box.max, FaceId(f)};
    }
  });
  for (int level = 0; level < leaf_level_; ++level) {
    // One task for many small nodes, one node a task where they are large.
    const std::size_t nodes = std::size_t{1} << level;
    for_blocks(nodes, std::max<std::size_t>(1, nodes * kBlock / size()), control, [&](std::size_t j, std::size_t last) {
      for (; j < last; ++j) {
        const std::size_t begin = node_begin(level, j), end = node_begin(level, j + 1);
        split(std::span(items).subspan(begin, end - begin), node_begin(level + 1, 2 * j + 1) - begin, control);
      }
    });
  }

  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) {
      face_[slot] = items[slot].face;
      slot_box_[slot] = box_of(faces[face_[slot].value], positions);
    }
  });
  node_box_.resize(node_index(leaf_level_ + 1, 0));
  for (int level = leaf_level_; level >= 0; --level)
    for_blocks(std::size_t{1} << level, kBlock, control, [&](std::size_t j, std::size_t last) {
      for (; j < last; ++j) {
        Box3& box = node_box_[node_index(level, j)];
        box = {};
        if (level < leaf_level_) {
          box.add(node_box_[node_index(level + 1, 2 * j)]);
          box.add(node_box_[node_index(level + 1, 2 * j + 1)]);
        } else {
          for (std::size_t slot = node_begin(level, j); slot < node_begin(level, j + 1); ++slot)
            box.add(slot_box_[slot]);
        }
      }
    });
}

}  // namespace remesh
