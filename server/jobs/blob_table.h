/// The inputs and results of jobs, in rows of the database or in files that rows name.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/jobs/blob_folder.h"
#include "server/jobs/database.h"

namespace remesh::server::jobs {

class BlobTable {
 public:
  /// Input: `folder` - the folder for inputs and results; null to store them in the database; `timeout` - the time that
  ///        the store may take for one piece of a blob.
  BlobTable(DatabaseDriver& driver, std::unique_ptr<BlobFolder> folder, std::chrono::milliseconds timeout)
      : driver_(driver), folder_(std::move(folder)), timeout_(timeout) {}

  /// The bytes of a blob, or the name of the file that holds them.
  struct Blob {
    std::string bytes;
    std::optional<std::string> file;
  };
  struct Size {
    std::uint64_t bytes = 0;
    std::optional<std::string> file;
  };

  void write(Database& database, const std::string& id, BlobKind kind, std::string_view bytes) const;
  /// Output: nothing if there is no such blob.
  /// Errors: BlobLost - a part of it is missing.
  std::optional<Blob> find(Database& database, const std::string& id, BlobKind kind) const;
  /// Output: as `find`; `bytes` is the size of the rows' bytes. If the size was stored with them, no data is read.
  /// Errors: BlobLost - the size and the rows contradict each other.
  std::optional<Size> size(Database& database, const std::string& id, BlobKind kind) const;
  /// Deletes the rows of a job's blobs for which a condition holds, a piece at a time. To be called in a transaction.
  /// Output: the files to remove once the transaction is committed.
  std::vector<std::string> remove(Database& database, const std::string& id, const char* condition) const;

  /// The folder for files.
  /// Errors: NoFolder.
  const BlobFolder& folder() const;
  /// Removes files whose rows are deleted.
  void remove_files(const std::vector<std::string>& files) const;
  /// Finds files whose transaction was never committed. One part of the folder is searched at each call.
  std::vector<std::string> find_stray_files(Database& database, int part) const;

 private:
  struct Extent {
    std::optional<std::string> file;
    std::optional<std::uint64_t> size;  ///< nothing if an older version of the daemon stored the blob
    std::int64_t last_part = 0;
  };
  /// Errors: as `size`.
  std::optional<Extent> extent(Database& database, const std::string& id, std::string_view kind) const;

  DatabaseDriver& driver_;
  const std::unique_ptr<BlobFolder> folder_;
  const std::chrono::milliseconds timeout_;
};

}  // namespace remesh::server::jobs
