#include "core/mending/weld/weld.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/coordinate_range.h"
#include "core/base/number_text.h"
#include "core/base/parallel.h"
#include "core/base/stoppable.h"
#include "core/mending/common/body_labels.h"
#include "core/mesh/equal_places.h"

namespace remesh {
namespace {

/// One entry per input vertex. The entries of vertices that no face uses are not set.
using Numbers = std::vector<std::uint32_t, DefaultInit<std::uint32_t>>;

/// A grid of cells that are twice as wide as the weld tolerance. Each axis of a cell is a whole number. If a coordinate
/// is so large that no other one is within the tolerance, it is the coordinate itself.
class Grid {
 public:
  using Cell = std::array<double, 3>;

  explicit Grid(double tolerance) : reach_(tolerance * (1 + 1e-15)), width_(2 * tolerance) {}

  // Adding 0 turns -0 into 0.
  Cell cell_of(const Vec3& p) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) cell[axis] = (is_alone(p[axis]) ? p[axis] : number_of(p[axis])) + 0.0;
    return cell;
  }

  /// Calls visit(cell) once for each cell that may have something within the tolerance of a place.
  template <class Visit>
  void for_each_near(const Vec3& p, const Visit& visit) const {
    const Axis x = near(p.x), y = near(p.y), z = near(p.z);
    for (int i = 0; i < x.count; ++i)
      for (int j = 0; j < y.count; ++j)
        for (int k = 0; k < z.count; ++k) visit(Cell{x.numbers[i], y.numbers[j], z.numbers[k]});
  }

 private:
  /// There are two numbers in nearly all cases. Rounding makes three if a place is in the middle of its cell, and more
  /// if coordinates have hardly more digits than the tolerance.
  static constexpr int kMaxNumbers = 5;
  struct Axis {
    std::array<double, kMaxNumbers> numbers;
    int count = 0;
  };

  bool is_alone(double x) const { return !(std::fabs(x) / width_ < 0x1p53); }
  double number_of(double x) const { return std::floor(x / width_) + 0.0; }

  Axis near(double x) const {
    Axis axis;
    if (is_alone(x)) {
      axis.numbers[axis.count++] = x + 0.0;
      return axis;
    }
    const double high = number_of(x + reach_);
    for (double number = number_of(x - reach_); number <= high && axis.count < kMaxNumbers; ++number)
      axis.numbers[axis.count++] = number;
    return axis;
  }

  double reach_, width_;
};

/// Finds the list of a cell by the cell's hash. Someone may have chosen the coordinates so that all cells have the same
/// hash.
class HashedCells {
 public:
  static constexpr bool kMayCollide = true;

  explicit HashedCells(std::size_t places) : mask_(std::bit_ceil(2 * places + 1) - 1) {}

  std::size_t count() const { return mask_ + 1; }
  std::size_t operator[](const Grid::Cell& cell) const {
    std::uint64_t hash = 0;
    for (const double c : cell) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash & mask_;
  }

 private:
  std::size_t mask_;
};

/// Finds the list of a cell by a search among all cells in order. This takes longer than a hash, but never much longer.
class SortedCells {
 public:
  static constexpr bool kMayCollide = false;

  SortedCells(std::span<const IndexedPlace> places, const Grid& grid, RunControl& control) {
    cells_.reserve(places.size());
    StopCheck check(control);
    for (const IndexedPlace& place : places) {
      check();
      cells_.push_back(grid.cell_of(place.position));
    }
    sort_unique(cells_, control);
  }

  /// The number of lists. The last one is that of all cells without a place.
  std::size_t count() const { return cells_.size() + 1; }
  std::size_t operator[](const Grid::Cell& cell) const {
    const auto at = std::lower_bound(cells_.begin(), cells_.end(), cell);
    return at != cells_.end() && *at == cell ? static_cast<std::size_t>(at - cells_.begin()) : cells_.size();
  }

 private:
  std::vector<Grid::Cell> cells_;
};

/// Welds within a tolerance. Vertices to which others are welded are further apart than the tolerance, so each cell has
/// only a few of them, and only a few cells are within reach.
template <class Cells>
class NearWelding {
 public:
  /// Input:  places, pairwise different, in lexicographic order.
  NearWelding(std::span<const IndexedPlace> places, double tolerance, const Grid& grid, const Cells& cells,
              RunControl& control)
      : places_(places), tolerance_(tolerance), grid_(grid), cells_(cells), check_(control) {
    heads_.assign(cells.count(), kNone);
    next_.assign(places.size(), kNone);
  }

  /// Output: false, without a usable result, if lists are so long that this would take quadratic time.
  bool run(Numbers& stands_for, Diagnostic& wide) {
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      const Near near = find_near(i);
      if (has_too_many_looks()) return false;
      if (near.count == 0) {
        std::uint32_t& head = heads_[cells_[grid_.cell_of(places_[i].position)]];
        next_[i] = std::exchange(head, i);
      } else {
        stands_for[places_[i].index] = places_[near.first].index;
      }
    }
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      if (stands_for[places_[i].index] != places_[i].index && find_near(i).count > 1) wide.add(places_[i].index);
      if (has_too_many_looks()) return false;
    }
    return true;
  }

 private:
  /// The number of vertices that are looked at around a place, on average. Places one tolerance apart fill eight cells
  /// with some sixty vertices.
  static constexpr std::size_t kMaxLooks = 128, kFewLooks = 1 << 20;

  struct Near {
    std::uint32_t first = 0;  ///< the smallest number
    std::uint32_t count = 0;
  };

  /// Finds the vertices within the tolerance to which other vertices have been welded.
  Near find_near(std::uint32_t i) {
    const Vec3 p = places_[i].position;
    Near near;
    grid_.for_each_near(p, [&](const Grid::Cell& cell) {
      for (std::uint32_t other = heads_[cells_[cell]]; other != kNone && !has_too_many_looks(); other = next_[other]) {
        check_();
        ++looks_;
        // Two cells with the same list would count a vertex twice otherwise.
        if (!(norm(places_[other].position - p) <= tolerance_) || grid_.cell_of(places_[other].position) != cell)
          continue;
        near.first = near.count == 0 ? other : std::min(near.first, other);
        ++near.count;
      }
    });
    check_();
    return near;
  }

  bool has_too_many_looks() const { return Cells::kMayCollide && looks_ > kFewLooks + kMaxLooks * places_.size(); }

  std::span<const IndexedPlace> places_;
  double tolerance_;
  const Grid& grid_;
  const Cells& cells_;
  StopCheck check_;
  std::size_t looks_ = 0;
  // Linked lists in two arrays, which are freed at once however many lists there are: the last vertex of each list, and
  // for each vertex the one before it.
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
};

/// Welds places within a tolerance. They are pairwise different and in lexicographic order.
void weld_near(std::span<const IndexedPlace> places, double tolerance, Numbers& stands_for, Diagnostic& wide,
               RunControl& control) {
  const Grid grid(tolerance);
  Diagnostic found = wide;
  if (const HashedCells cells(places.size());
      NearWelding(places, tolerance, grid, cells, control).run(stands_for, found)) {
    wide = std::move(found);
    return;
  }
  // The welds of the first attempt are undone.
  StopCheck check(control);
  for (const IndexedPlace& place : places) {
    check();
    stands_for[place.index] = place.index;
  }
  const SortedCells cells(places, grid, control);
  NearWelding(places, tolerance, grid, cells, control).run(stands_for, wide);
}

std::string place_text(const Vec3& p) {
  return "(" + number_text(p.x) + ", " + number_text(p.y) + ", " + number_text(p.z) + ")";
}

/// An error that names a vertex, by its number in the input, and its place.
Error out_of_range(const Surface& surface, std::size_t v, const std::string& message) {
  const std::uint32_t number = surface.vertex_source[VertexId(v)].value;
  return Error(Code::kCoordinateRange, Stage::kWeld,
               message + "; vertex " + std::to_string(number) + " is at " + place_text(surface.positions[VertexId(v)]))
      .at_element(number);
}

/// Reports the first vertex that is too far from the origin.
/// Input: the bounding box of the surface is too large, so there is such a vertex.
[[noreturn]] void throw_too_large(const Surface& surface) {
  std::size_t v = 0;
  const auto is_far = [&](const Vec3& p) {
    return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) >= CoordinateRange::kFarthest;
  };
  while (v + 1 < surface.vertex_count() && !is_far(surface.positions[VertexId(v)])) ++v;
  throw out_of_range(
      surface, v,
      "coordinates differ by more than can be computed with: no vertex may be over 2^1022 (4.5e307) away "
      "from the middle of the mesh. Scale the mesh down, or correct the vertex that lies far off");
}

/// Reports the vertex that is farthest from the median along the mesh's longest axis.
[[noreturn]] void throw_too_narrow(const Surface& surface, int axis, double length, double width) {
  const std::size_t n = surface.vertex_count();
  std::vector<double> along(n);
  for (std::size_t v = 0; v < n; ++v) along[v] = surface.positions[VertexId(v)][axis];
  const auto middle = along.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(along.begin(), middle, along.end());
  const double usual = *middle;
  std::size_t farthest = 0;
  const auto distance = [&](std::size_t v) { return std::fabs(surface.positions[VertexId(v)][axis] / 2 - usual / 2); };
  for (std::size_t v = 1; v < n; ++v)
    if (distance(v) > distance(farthest)) farthest = v;
  throw out_of_range(
      surface, farthest,
      "the mesh is " + number_text(length) + " long and only " + number_text(width) +
          " wide. A mesh narrower than 2^-100 (7.9e-31) of its length cannot be told from a line, and no "
          "result can be proven for it. Correct the vertex that lies far off, or leave its faces out");
}

/// Throws if the box's second longest side is too short relative to its longest side.
void refuse_lines(const Surface& surface, const Box3& box) {
  // Differences of halves do not overflow.
  const Vec3 half = 0.5 * box.max - 0.5 * box.min;
  std::array<double, 3> sides{half.x, half.y, half.z};
  std::sort(sides.begin(), sides.end());
  // If all vertices are exactly on a line along an axis, there are only faces without area, which is reported later.
  if (sides[1] == 0 || sides[1] >= CoordinateRange::kNarrowest * sides[2]) return;
  const int axis = half.x == sides[2] ? 0 : half.y == sides[2] ? 1 : 2;
  throw_too_narrow(surface, axis, 2 * sides[2], 2 * sides[1]);
}

void set_local_units(Surface& surface, RunControl& control) {
  const std::size_t n = surface.vertex_count();
  Box3 box;
  for (const Box3& part : map_blocks<Box3>(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
         Box3 of_block;
         for (std::size_t v = begin; v < end; ++v) of_block.add(surface.positions[VertexId(v)]);
         return of_block;
       }))
    box.add(part);
  const Vec3 centre = 0.5 * box.min + 0.5 * box.max;
  surface.centre = centre;
  const Vec3 half = box.max - centre;
  int exponent = 0;
  const double largest = std::max({half.x, half.y, half.z});
  std::frexp(largest, &exponent);
  // Coordinates in the frame of a patch may be twice as large, and must not overflow either.
  if (exponent > std::ilogb(CoordinateRange::kFarthest)) throw_too_large(surface);
  // Smaller doubles are subnormal and have too few digits for points in a plane.
  if (largest < CoordinateRange::kSmallest && box.min != box.max)
    throw out_of_range(surface, 0,
                       "the mesh is too small to compute with: all its vertices are less than 2^-1022 (2.2e-308) away "
                       "from its middle. Scale it up");
  refuse_lines(surface, box);
  surface.unit = std::ldexp(1.0, exponent);
  surface.local = FilledIdVector<VertexId, Vec3>::of_size(n);
  for_blocks(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      surface.local[VertexId(v)] = surface.to_local(surface.positions[VertexId(v)]);
  });
}

/// The vertices after welding. They are in the input's order, each at the place of the first vertex that is welded to
/// it.
struct Welded {
  FilledIdVector<VertexId, VertexId> source;  ///< number in the input
  Numbers of_input;                           ///< for each input vertex, the welded one
};

Welded number_welded(const std::vector<std::uint8_t>& is_used, const Numbers& stands_for, Diagnostic& duplicate,
                     RunControl& control) {
  Welded welded;
  welded.of_input.assign(is_used.size(), VertexId::kInvalid);
  StopCheck check(control);
  for (std::uint32_t i = 0; i < is_used.size(); ++i) {
    check();
    if (!is_used[i]) continue;
    // With a tolerance, if two vertices have equal coordinates, the entry of the first one says which vertex both
    // become.
    const std::uint32_t one = stands_for[stands_for[i]];
    if (one != i) duplicate.add(i);
    if (welded.of_input[one] == VertexId::kInvalid) {
      welded.of_input[one] = static_cast<std::uint32_t>(welded.source.size());
      welded.source.push_back(VertexId(one));
    }
    welded.of_input[i] = welded.of_input[one];
  }
  return welded;
}

/// Returns whether all vertices are used, and none becomes another one.
bool are_all_single(const std::vector<std::uint8_t>& is_used, const Numbers& stands_for, RunControl& control) {
  const auto are_single = map_blocks<std::uint8_t>(is_used.size(), kItemsPerBlock, control,
                                                   [&](std::size_t begin, std::size_t end) -> std::uint8_t {
                                                     for (std::size_t i = begin; i < end; ++i)
                                                       if (is_used[i] == 0 || stands_for[i] != i) return 0;
                                                     return 1;
                                                   });
  return std::find(are_single.begin(), are_single.end(), 0) == are_single.end();
}

}  // namespace

Surface weld(const PolygonMesh& input, const Barriers& barriers, std::vector<Diagnostic>& diagnostics,
             RunControl& control, double tolerance) {
  if (input.face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kWeld, "the mesh has no face");
  const std::size_t n = input.vertex_count();
  Diagnostic unused{DiagnosticCode::kUnusedVertex, 0, {}, "vertices that no face uses were dropped"};
  Diagnostic duplicate{DiagnosticCode::kDuplicateVertex, 0, {}, "vertices with equal coordinates were merged"};
  Diagnostic wide{DiagnosticCode::kDuplicateVertex,
                  0,
                  {},
                  "merged vertices lie within `weld_tolerance` of another vertex that was not merged with them"};

  std::vector<std::uint8_t> is_used(n, 0);
  for_blocks(input.corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      std::atomic_ref(is_used[input.corners[c].value]).store(1, std::memory_order_relaxed);
  });
  for (const VertexId v : select_ids<VertexId>(n, kItemsPerBlock, control, [&](std::size_t v) { return !is_used[v]; }))
    unused.add(v.value);
  Numbers stands_for(n);
  std::vector<IndexedPlace> sorted;
  const std::vector<Vec3>& positions = input.positions.items();
  if (tolerance > 0 || !find_equal_by_hash(positions, is_used, stands_for, control))
    sorted = find_equal_by_sort(positions, is_used, stands_for, control);
  if (tolerance > 0) {
    duplicate.message = "vertices within `weld_tolerance` of another vertex were merged with it";
    StopCheck check(control);
    const auto is_repeated = [&](const IndexedPlace& v) {
      check();
      return stands_for[v.index] != v.index;
    };
    sorted.erase(std::remove_if(sorted.begin(), sorted.end(), is_repeated), sorted.end());
    weld_near(sorted, tolerance, stands_for, wide, control);
  }

  control.check();
  Surface surface;
  const std::size_t faces = input.face_count();
  surface.face_begin = CopyOnWrite<std::size_t, std::uint32_t>::of(input.face_begin);
  surface.face_source = FilledIdVector<FaceId, FaceId>::of_size(faces);
  for_blocks(faces, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) surface.face_source[FaceId(f)] = FaceId(f);
  });
  if (are_all_single(is_used, stands_for, control)) {  // the usual case
    surface.positions = CopyOnWrite<VertexId, Vec3>::of(input.positions.items());
    surface.corners = CopyOnWrite<std::size_t, VertexId>::of(input.corners);
    surface.vertex_source = FilledIdVector<VertexId, VertexId>::of_size(n);
    for_blocks(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) surface.vertex_source[VertexId(v)] = VertexId(v);
    });
  } else {
    Welded welded = number_welded(is_used, stands_for, duplicate, control);
    std::vector<Vec3> positions(welded.source.size());
    for_blocks(positions.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) positions[v] = input.positions[welded.source[VertexId(v)]];
    });
    std::vector<VertexId> corners(input.corners.size());
    for_blocks(corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) corners[c] = VertexId(welded.of_input[input.corners[c].value]);
    });
    surface.positions = std::move(positions);
    surface.corners = std::move(corners);
    surface.vertex_source = std::move(welded.source);
  }
  set_local_units(surface, control);
  surface.face_label = number_labels(input.labels, barriers, faces, control);

  for (Diagnostic* d : {&duplicate, &wide, &unused})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
  return surface;
}

}  // namespace remesh
