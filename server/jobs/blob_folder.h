/// Inputs and results as files of a folder that all daemons share.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

class BlobFolder {
 public:
  /// Makes the folder where there is none. Errors: StoreError - that cannot be done, or it cannot be written.
  explicit BlobFolder(std::string path);

  /// Writes a new file. Output: its name, never given twice.
  /// Holds:  when this returns, the file is on the disk, whole, under that name.
  /// Errors: StoreError.
  std::string write(const std::string& id, std::string_view kind, std::string_view bytes) const;
  /// Errors: BlobLost - there is no such file, or the disk does not give it back; StoreError - it cannot be read now.
  std::string read(const std::string& name) const;
  /// In bytes. Errors: as `read`.
  std::uint64_t size(const std::string& name) const;
  /// What cannot be removed stays.
  void remove(const std::string& name) const noexcept;

  static constexpr int kParts = 256;
  struct Found {
    std::string name;
    std::string job;
  };
  /// The files of one of the `kParts` parts that were written so long ago, unfinished ones too.
  std::vector<Found> files_older_than(std::chrono::hours age, int part) const;

 private:
  const std::string path_;
};

}  // namespace remesh::server::jobs
