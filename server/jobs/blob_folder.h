/// Inputs and results of jobs, stored as files in a folder that all daemons share.
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
  /// Creates the folder if it does not exist.
  /// Errors: StoreError - the folder cannot be created or is not writable.
  explicit BlobFolder(std::string path);

  /// Writes a new file.
  /// Output: the file's name, which is never given twice.
  /// Holds:  when the function returns, the whole file is on the disk under that name.
  /// Errors: StoreError.
  std::string write(const std::string& id, std::string_view kind, std::string_view bytes) const;
  /// Reads a whole file.
  /// Errors: BlobLost - the file does not exist, or the disk cannot return its bytes; StoreError - it cannot be read
  ///         now.
  std::string read(const std::string& name) const;
  /// Returns the size of a file in bytes.
  /// Errors: as `read`.
  std::uint64_t size(const std::string& name) const;
  /// Removes a file. A file that cannot be removed stays, without an error.
  void remove(const std::string& name) const noexcept;

  static constexpr int kParts = 256;
  struct Found {
    std::string name;
    std::string job;
  };
  /// Lists the files in one of the `kParts` parts that were last written longer ago than `age`. Unfinished files are
  /// listed too.
  std::vector<Found> files_older_than(std::chrono::hours age, int part) const;

 private:
  const std::string path_;
};

}  // namespace remesh::server::jobs
