#include "core/geometry/trees/triangle_tree.h"

#include <algorithm>

#include "core/base/blocks.h"
#include "core/base/loop_progress.h"
#include "core/geometry/trees/split_by_shape.h"

namespace remesh {
namespace {

/// A triangle on its way to its slot.
struct Item {
  Vec3 centre;  ///< twice the centre of the triangle's box, which avoids one rounding
  FaceId face;
};

Box3 box_of(const Triangle& face, std::span<const Vec3> positions) {
  Box3 box;
  for (const VertexId v : face) box.add(positions[v.value]);
  return box;
}

constexpr std::size_t kFacesBetweenChecks = 1 << 16;

/// Nodes with more faces are split by place alone, because groups may be wide, or lie in one another.
constexpr std::size_t kManyFaces = 1 << 13;

/// Groups of faces. They are split like faces, by the places of whole groups, until a node has a single group.
class Groups {
 public:
  template <class Item>
  Groups(std::span<const std::uint32_t> of_face, const std::vector<Item, DefaultInit<Item>>& items, RunControl& control)
      : of_face_(of_face) {
    if (of_face.empty()) return;
    std::vector<Box3> boxes;
    for (const Item& item : items) {
      if (item.face.value % kFacesBetweenChecks == 0) control.check_and_move();
      if (!is_in_group(item)) continue;
      const std::uint32_t group = of_face_[item.face.value];
      if (group >= boxes.size()) boxes.resize(group + 1);
      boxes[group].add(item.centre);
    }
    for (const Box3& box : boxes) centres_.push_back(0.5 * box.min + 0.5 * box.max);
  }

  template <class Item>
  bool is_one(std::span<Item> items) const {
    return of_face_.empty() || std::all_of(items.begin(), items.end(), [&](const Item& item) {
             return of_face_[item.face.value] == of_face_[items[0].face.value];
           });
  }
  const Vec3& centre(const auto& item) const {
    return is_in_group(item) ? centres_[of_face_[item.face.value]] : item.centre;
  }
  std::pair<std::uint32_t, FaceId> tie(const auto& item) const { return {of_face_[item.face.value], item.face}; }

 private:
  bool is_in_group(const auto& item) const { return of_face_[item.face.value] != TriangleTree::kNoGroup; }

  std::span<const std::uint32_t> of_face_;
  std::vector<Vec3> centres_;  ///< for each group, the centre of the box around its faces' centres
};

constexpr std::size_t kBlock = 4096;

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> faces, RunControl& control,
                           std::span<const std::uint32_t> groups, Split split)
    : slots_(faces.size()), face_(faces.size()) {
  if (faces.empty()) {
    node_box_.assign(1, Box3());
    return;
  }
  const auto centre_of = [&](std::size_t f) {
    const Box3 box = box_of(faces[f], positions);
    return box.min + box.max;
  };
  if (split == kByPlace) {
    sort<Item>(
        [&](std::size_t f) {
          return Item{centre_of(f), FaceId(f)};
        },
        groups, control,
        [&](std::span<Item> node, std::size_t middle) {
          split_widest(
              node, middle, [](const Item& i) -> const Vec3& { return i.centre; }, [](const Item& i) { return i.face; },
              control);
        });
  } else {
    // The nodes of one level contain every face once.
    LoopProgress progress(control, faces.size() * static_cast<std::size_t>(slots_.leaf_level()));
    sort<ShapedItem>(
        [&](std::size_t f) {
          return ShapedItem{place_of(faces[f], positions), reach_of(faces[f], positions), 0, FaceId(f)};
        },
        groups, control,
        [&](std::span<ShapedItem> node, std::size_t middle) {
          split_by_shape(node, middle, control);
          progress.add(node.size());
        });
  }
  slot_box_.resize(size());
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) {
      slot_box_[slot] = box_of(faces[face_[slot].value], positions);
    }
  });
  node_box_.resize(slots_.node_count());
  const auto of_slots = [&](std::size_t slot, std::size_t end) {
    Box3 box;
    for (; slot < end; ++slot) box.add(slot_box_[slot]);
    return box;
  };
  const auto joined = [](Box3 box, const Box3& other) {
    box.add(other);
    return box;
  };
  slots_.join(std::span(node_box_), control, of_slots, joined);
}

template <class Item, class ItemOf, class SplitNode>
void TriangleTree::sort(const ItemOf& item_of, std::span<const std::uint32_t> groups, RunControl& control,
                        const SplitNode& split) {
  std::vector<Item, DefaultInit<Item>> items(size());
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) items[f] = item_of(f);
  });
  const Groups of_items(groups, items, control);
  slots_.sort(std::span(items), control, [&](std::span<Item> node, std::size_t middle) {
    if (node.size() > kManyFaces || of_items.is_one(node)) return split(node, middle);
    split_widest(
        node, middle, [&](const Item& i) -> const Vec3& { return of_items.centre(i); },
        [&](const Item& i) { return of_items.tie(i); }, control);
  });
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) face_[slot] = items[slot].face;
  });
}

}  // namespace remesh
