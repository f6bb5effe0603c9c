/// Collects the labels of faces while a file is read.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "core/mesh/mesh.h"

namespace remesh {

/// Largest length of a name in bytes. Writers repeat a name whenever the label changes, so a long name could make the
/// output huge.
inline constexpr std::size_t kMaxNameLength = 4096;

/// Collects the labels of one kind. A name that no face has is not stored.
class LabelCollector {
 public:
  /// Sets the name for the faces that follow.
  void name(std::string label) {
    is_named_ = true;
    index_is_known_ = false;
    name_ = std::move(label);
  }

  void add_face(std::size_t faces_before) { add_faces(faces_before, 1); }
  void add_faces(std::size_t faces_before, std::size_t count) {
    if (!is_named_ || count == 0) return;
    if (set_.of_face.empty() && faces_before > 0) set_.of_face.assign(faces_before, index_of(""));
    if (!index_is_known_) {
      index_ = index_of(name_);
      index_is_known_ = true;
    }
    set_.of_face.resize(faces_before + count, index_);
  }

  LabelSet take() { return std::move(set_); }

 private:
  std::uint32_t index_of(const std::string& label) {
    const auto [entry, is_new] = index_of_name_.try_emplace(label, static_cast<std::uint32_t>(set_.names.size()));
    if (is_new) set_.names.push_back(label);
    return entry->second;
  }

  LabelSet set_;
  // This is not a hash table, because the names come from outside and could be made to collide.
  std::map<std::string, std::uint32_t> index_of_name_;
  std::string name_;
  std::uint32_t index_ = 0;
  bool is_named_ = false;
  bool index_is_known_ = false;
};

}  // namespace remesh
