#include "core/mending/common/body_labels.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// The number of each input face; empty if all have the same labels.
IdVector<FaceId, std::uint32_t> number_all(const FaceLabels& labels, RunControl& control) {
  const std::size_t faces =
      std::max({labels.object.of_face.size(), labels.group.of_face.size(), labels.material.of_face.size()});
  IdVector<FaceId, std::uint32_t> numbers = number_labels(labels, {true, true, true}, faces, control);
  if (std::all_of(numbers.begin(), numbers.end(), [](std::uint32_t n) { return n == 0; })) numbers.clear();
  return numbers;
}

/// One set with a single label for each number.
BodyLabels single_labels(const IdVector<FaceId, std::uint32_t>& numbers) {
  BodyLabels result;
  const std::uint32_t count = *std::max_element(numbers.begin(), numbers.end()) + 1;
  for (std::uint32_t n = 0; n < count; ++n) {
    result.labels.push_back(n);
    result.begin.push_back(n + 1);
  }
  return result;
}

}  // namespace

IdVector<FaceId, std::uint32_t> number_labels(const FaceLabels& labels, const Barriers& barriers, std::size_t faces,
                                              RunControl& control) {
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
  std::map<Key, std::size_t> number_of;
  Key last;
  std::size_t number = 0;
  const auto separates = [](const LabelSet& set, bool is_barrier) { return is_barrier && set.is_used(); };
  if (!separates(labels.object, barriers.object) && !separates(labels.group, barriers.group) &&
      !separates(labels.material, barriers.material))
    return {};
  IdVector<FaceId, std::uint32_t> numbers(faces, 0);
  const auto label = [&](const LabelSet& set, bool is_barrier, FaceId f) {
    return separates(set, is_barrier) ? set.of_face[f] : 0u;
  };
  StopCheck check(control);
  for (std::size_t i = 0; i < faces; ++i) {
    check();
    const FaceId f(i);
    const Key key{label(labels.object, barriers.object, f), label(labels.group, barriers.group, f),
                  label(labels.material, barriers.material, f)};
    if (i == 0 || key != last) number = number_of.try_emplace(key, number_of.size()).first->second;
    last = key;
    numbers[f] = static_cast<std::uint32_t>(number);
  }
  return numbers;
}

BodyLabels labels_of_sources(const FaceLabels& labels, std::span<const FaceId> source, RunControl& control) {
  const IdVector<FaceId, std::uint32_t> numbers = number_all(labels, control);
  if (numbers.empty()) return {};
  BodyLabels result = single_labels(numbers);
  result.set_of.resize(source.size());
  for_blocks(source.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) result.set_of[f] = numbers[source[f]];
  });
  return result;
}

BodyLabels labels_of_patches(const FaceLabels& labels, const Surface& surface, const PatchSet& patches,
                             RunControl& control) {
  const IdVector<FaceId, std::uint32_t> numbers = number_all(labels, control);
  if (numbers.empty()) return {};
  BodyLabels result = single_labels(numbers);
  std::map<std::vector<std::uint32_t>, std::uint32_t> number_of_set;
  result.set_of.resize(patches.count());
  std::vector<std::uint32_t> of_patch;
  std::size_t looks = 0;
  for (std::size_t p = 0; p < patches.count(); ++p) {
    of_patch.clear();
    for (const FaceId f : patches.faces_of(PatchId(p))) {
      if (looks++ % kItemsPerBlock == 0) control.check_and_move();
      const std::uint32_t number = numbers[surface.face_source[f]];
      if (of_patch.empty() || of_patch.back() != number) of_patch.push_back(number);
    }
    sort_unique(of_patch);
    if (of_patch.size() == 1) {
      result.set_of[p] = of_patch[0];
      continue;
    }
    const auto next = static_cast<std::uint32_t>(result.begin.size() - 1);
    const auto [entry, is_new] = number_of_set.try_emplace(of_patch, next);
    result.set_of[p] = entry->second;
    if (!is_new) continue;
    result.labels.insert(result.labels.end(), of_patch.begin(), of_patch.end());
    result.begin.push_back(static_cast<std::uint32_t>(result.labels.size()));
  }
  return result;
}

BodyLabels labels_of_result(const BodyLabels& of_patches, std::span<const PatchId> face_patch, RunControl& control) {
  if (of_patches.are_alike()) return {};
  BodyLabels result{std::vector<std::uint32_t>(face_patch.size()), of_patches.begin, of_patches.labels};
  for_blocks(face_patch.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) result.set_of[f] = of_patches.set_of[face_patch[f].value];
  });
  return result;
}

}  // namespace remesh
