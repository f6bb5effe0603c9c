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
/// Input:   centre(item): where it is; tie(item): an order of those at one place.
template <class Centre, class Tie>
void split(std::span<Item> items, std::size_t middle, const Centre& centre, const Tie& tie, RunControl& control) {
  control.check();
  Box3 centres;
  for (const Item& item : items) centres.add(centre(item));
  const int axis = longest_axis(centres);
  std::uint32_t comparisons = 0;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [&](const Item& a, const Item& b) {
                     if (++comparisons % (1u << 16) == 0) control.check();
                     const double a_place = centre(a)[axis], b_place = centre(b)[axis];
                     return a_place != b_place ? a_place < b_place : tie(a) < tie(b);
                   });
}

constexpr std::size_t kFacesBetweenChecks = 1 << 16;

/// Nodes of more faces are split by places alone: groups may be wide, and one in another.
constexpr std::size_t kManyFaces = 1 << 13;

/// Groups are split like faces, by the places of all of them, until there is one in a node.
class Groups {
 public:
  Groups(std::span<const std::uint32_t> of_face, std::span<const Item> items, RunControl& control) : of_face_(of_face) {
    if (of_face.empty()) return;
    std::vector<Box3> boxes;
    for (const Item& item : items) {
      if (item.face.value % kFacesBetweenChecks == 0) control.check();
      if (!is_in_group(item)) continue;
      const std::uint32_t group = of_face_[item.face.value];
      if (group >= boxes.size()) boxes.resize(group + 1);
      boxes[group].add(item.centre);
    }
    for (const Box3& box : boxes) centres_.push_back(0.5 * box.min + 0.5 * box.max);
  }

  bool is_one(std::span<const Item> items) const {
    return of_face_.empty() || std::all_of(items.begin(), items.end(), [&](const Item& item) {
             return of_face_[item.face.value] == of_face_[items[0].face.value];
           });
  }
  const Vec3& centre(const Item& item) const {
    return is_in_group(item) ? centres_[of_face_[item.face.value]] : item.centre;
  }
  std::pair<std::uint32_t, FaceId> tie(const Item& item) const { return {of_face_[item.face.value], item.face}; }

 private:
  bool is_in_group(const Item& item) const { return of_face_[item.face.value] != TriangleTree::kNoGroup; }

  std::span<const std::uint32_t> of_face_;
  std::vector<Vec3> centres_;  ///< of the boxes of its faces' centres
};

constexpr std::size_t kBlock = 4096;

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> faces, RunControl& control,
                           std::span<const std::uint32_t> groups)
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
  const Groups of_items(groups, items, control);
  for (int level = 0; level < leaf_level_; ++level) {
    // One task for many small nodes, one node a task where they are large.
    const std::size_t nodes = std::size_t{1} << level;
    for_blocks(nodes, std::max<std::size_t>(1, nodes * kBlock / size()), control, [&](std::size_t j, std::size_t last) {
      for (; j < last; ++j) {
        const std::size_t begin = node_begin(level, j), end = node_begin(level, j + 1);
        const auto node = std::span(items).subspan(begin, end - begin);
        const std::size_t middle = node_begin(level + 1, 2 * j + 1) - begin;
        if (node.size() > kManyFaces || of_items.is_one(node))
          split(
              node, middle, [](const Item& i) -> const Vec3& { return i.centre; }, [](const Item& i) { return i.face; },
              control);
        else
          split(
              node, middle, [&](const Item& i) -> const Vec3& { return of_items.centre(i); },
              [&](const Item& i) { return of_items.tie(i); }, control);
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
