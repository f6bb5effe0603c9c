/// Keeps earlier or later triangulations of patches while other ones are in use.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/parallel.h"
#include "core/patch_types/patch_mesh.h"

namespace remesh {

/// Triangulations of some patches that can replace the present ones.
class PatchBackup {
 public:
  PatchBackup() = default;
  /// Input: one mesh for each id; no id twice.
  PatchBackup(std::vector<PatchId> ids, std::vector<PatchMesh> meshes)
      : ids_(std::move(ids)), meshes_(std::move(meshes)) {}
  ~PatchBackup() { clear(); }
  PatchBackup(PatchBackup&& other) noexcept : ids_(std::move(other.ids_)), meshes_(std::move(other.meshes_)) {}
  PatchBackup& operator=(PatchBackup&& other) noexcept {
    std::swap(ids_, other.ids_);
    std::swap(meshes_, other.meshes_);
    other.clear();
    return *this;
  }

  /// Swaps these patches with the patches in `meshes` that have the same ids.
  void exchange_with(PatchMeshes& meshes) {
    for (std::size_t i = 0; i < ids_.size(); ++i) std::swap(meshes[ids_[i]], meshes_[i]);
  }
  /// Adds a patch whose id is not there yet.
  void add(PatchId id, PatchMesh mesh) {
    ids_.push_back(id);
    meshes_.push_back(std::move(mesh));
  }
  std::span<const PatchId> ids() const { return ids_; }
  /// Frees the meshes in parallel, because there may be a million.
  void clear() {
    ids_.clear();
    free_in_parallel(meshes_);
  }

 private:
  std::vector<PatchId> ids_;
  std::vector<PatchMesh> meshes_;
};

}  // namespace remesh
