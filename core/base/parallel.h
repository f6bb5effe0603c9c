/// Parallel loops and sorts, in a form that may be nested. What they run is called through pointers, so that sources do
/// not compile TBB's loops for themselves: that took a third of the time to compile the core.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

namespace remesh {
namespace parallel {

/// Calls `call(body, from, to)` for ranges that make up [begin, end) together, in parallel. A range of at most `few`
/// items is not divided.
void run_ranges(std::size_t begin, std::size_t end, std::size_t few,
                void (*call)(const void* body, std::size_t from, std::size_t to), const void* body);

/// Does the same for [0, end), whether or not the caller's group of tasks has been cancelled. If there is no memory for
/// tasks, some ranges are left out.
void run_all_ranges(std::size_t end, std::size_t few, void (*call)(const void* body, std::size_t from, std::size_t to),
                    const void* body) noexcept;

/// The steps of sorting the items begin .. end - 1 of a row.
struct SortSteps {
  const void* row;
  void (*sort)(const void* row, std::size_t begin, std::size_t end);
  /// Puts items below one of them before it, and all others behind.
  /// Output: where items begin and end that are equal to it and need no more sorting. There may be others behind them.
  std::pair<std::size_t, std::size_t> (*divide)(const void* row, std::size_t begin, std::size_t end);
};
void run_sort(const SortSteps& steps, std::size_t n);

template <class Iterator, class Less>
struct Row {
  Iterator first;
  const Less& less;

  Iterator at(std::size_t i) const { return first + static_cast<std::ptrdiff_t>(i); }
  Iterator median(std::size_t a, std::size_t b, std::size_t c) const {
    const Iterator x = at(a), y = at(b), z = at(c);
    if (less(*x, *y)) return less(*y, *z) ? y : less(*x, *z) ? z : x;
    return less(*x, *z) ? x : less(*y, *z) ? z : y;
  }

  static void sort(const void* row, std::size_t begin, std::size_t end) {
    const auto& [first, less] = *static_cast<const Row*>(row);
    std::sort(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end), less);
  }
  static std::pair<std::size_t, std::size_t> divide(const void* row, std::size_t begin, std::size_t end) {
    const Row& self = *static_cast<const Row*>(row);
    const std::size_t step = (end - begin) / 9;
    std::array<std::size_t, 3> medians;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = begin + 3 * i * step;
      medians[i] = static_cast<std::size_t>(self.median(k, k + step, k + 2 * step) - self.first);
    }
    const Iterator one = self.at(begin);
    std::iter_swap(one, self.median(medians[0], medians[1], medians[2]));
    const auto is_below = [&](const auto& item) { return self.less(item, *one); };
    const Iterator middle = std::partition(one + 1, self.at(end), is_below) - 1;
    std::iter_swap(one, middle);
    Iterator above = middle + 1;
    // Where hardly any item is below, there may be many that are equal.
    if (static_cast<std::size_t>(middle - one) < step)
      above = std::partition(above, self.at(end), [&](const auto& item) { return !self.less(*middle, item); });
    return {static_cast<std::size_t>(middle - self.first), static_cast<std::size_t>(above - self.first)};
  }
};

}  // namespace parallel

/// Calls `body(from, to)` for ranges that make up [begin, end) together, in parallel. A range of at most `few`
/// items is not divided. A plain loop of TBB inside a task of another loop has two surprising properties:
/// - When a task has thrown, the inner loops of all other tasks end at once, with their work undone, and return as if
///   it were done. In that case this function throws, so that no result is made of undone work. The outer loop then
///   throws the first exception.
/// - A thread that waits for an inner loop takes any task there is, so outer tasks would pile up on its stack. Here it
///   takes only tasks of the inner loop.
template <class Body>
void for_ranges(std::size_t begin, std::size_t end, std::size_t few, const Body& body) {
  parallel::run_ranges(
      begin, end, few,
      [](const void* of_caller, std::size_t from, std::size_t to) { (*static_cast<const Body*>(of_caller))(from, to); },
      &body);
}

/// Calls `body(i)` for all i of [begin, end), in the same way.
template <class Body>
void for_all(std::size_t begin, std::size_t end, const Body& body) {
  for_ranges(begin, end, 1, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) body(i);
  });
}

/// Work on fewer items is not worth waking a thread.
inline constexpr int kItemsWorthThreads = 500;

/// Sorts like std::sort, in parallel unless there are few items.
template <class Iterator, class Less = std::less<>>
void sort_all(Iterator begin, Iterator end, const Less& less = {}, std::ptrdiff_t few = kItemsWorthThreads) {
  if (end - begin < few) return std::sort(begin, end, less);
  if (std::is_sorted(begin, end, less)) return;
  using Row = parallel::Row<Iterator, Less>;
  const Row row{begin, less};
  parallel::run_sort({&row, Row::sort, Row::divide}, static_cast<std::size_t>(end - begin));
}

/// Runs the parts in parallel, or one after the other if they work on few items.
template <class... Parts>
void do_all(std::size_t items, const Parts&... parts) {
  if (items < kItemsWorthThreads) return (parts(), ...);
  const std::array<const void*, sizeof...(Parts)> all{&parts...};
  constexpr std::array<void (*)(const void*), sizeof...(Parts)> calls{
      [](const void* part) { (*static_cast<const Parts*>(part))(); }...};
  for_all(0, all.size(), [&](std::size_t i) { calls[i](all[i]); });
}

/// Empties a vector whose items own memory, in parallel. Freeing the memory of a million patches takes a tenth of a
/// second, which a cancelled run would still have to wait for.
/// Holds:  nothing is thrown. The work is parallel even if the caller's group of tasks has been cancelled, but not if
///         there is no memory for tasks.
template <class T>
void free_in_parallel(std::vector<T>& items) noexcept {
  constexpr std::size_t kFew = 1 << 12;
  T* const first = items.data();
  if (items.size() > kFew)
    parallel::run_all_ranges(
        items.size(), kFew,
        [](const void* all, std::size_t from, std::size_t to) {
          for (std::size_t i = from; i < to; ++i) const T gone = std::move((*static_cast<T* const*>(all))[i]);
        },
        &first);
  // The items that are left are freed with the vector.
  std::vector<T>().swap(items);
}

/// A vector that is emptied by free_in_parallel when it goes out of scope.
template <class T>
struct FreedInParallel {
  FreedInParallel() = default;
  ~FreedInParallel() { free_in_parallel(items); }
  FreedInParallel(const FreedInParallel&) = delete;
  FreedInParallel& operator=(const FreedInParallel&) = delete;

  std::vector<T> items;
};

}  // namespace remesh
