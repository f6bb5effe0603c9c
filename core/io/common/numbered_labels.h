/// Collects labels that are numbers in the file.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/mesh/mesh.h"

namespace remesh {

/// Collects the numbers of all faces, one after the other.
class NumberedLabels {
 public:
  using Names = std::map<std::int64_t, std::string>;

  void add_face(std::int64_t number) { add_faces(number, 1); }
  void add_faces(std::int64_t number, std::size_t count) {
    if (count == 0) return;
    if (of_face_.empty() || number != last_) {
      last_ = number;
      index_ = index_of_.try_emplace(number, static_cast<std::uint32_t>(index_of_.size())).first->second;
    }
    of_face_.resize(of_face_.size() + count, index_);
  }

  /// Makes labels of the numbers. A number without a name has its digits as its name.
  /// Output: no labels if all numbers are 0, and 0 has no name.
  LabelSet take(const Names& names) {
    LabelSet set;
    const bool is_plain = index_of_.empty() || (index_of_.size() == 1 && index_of_.contains(0) && !names.contains(0));
    if (is_plain) return set;
    set.names.resize(index_of_.size());
    for (const auto& [number, index] : index_of_) {
      const auto name = names.find(number);
      set.names[index] = name == names.end() ? std::to_string(number) : name->second;
    }
    set.of_face = std::move(of_face_);
    return set;
  }

 private:
  std::map<std::int64_t, std::uint32_t> index_of_;
  IdVector<FaceId, std::uint32_t> of_face_;
  std::int64_t last_ = 0;
  std::uint32_t index_ = 0;
};

}  // namespace remesh
