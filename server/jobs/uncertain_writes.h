/// Writes whose effect is unknown, because the store's answer did not come. They are undone once the store answers
/// again, so that a client that was told "try again" has no running job, and no job waits for a worker that does not
/// know of its claim.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/blob_table.h"
#include "server/jobs/database.h"

namespace remesh::server::jobs {

class UncertainWrites {
 public:
  void record_submission(const std::string& id) { record({id, Kind::kSubmission, std::nullopt}); }
  /// Input: `worker` - the name under which the claim was made, which no other claim has.
  void record_claim(const std::string& worker) { record({worker, Kind::kClaim, std::nullopt}); }

  /// True if there are writes that `undo` has not searched for yet.
  bool has_new() const;
  /// Undoes those of the writes that took effect. A frozen server may execute a write after it has answered again, so
  /// each write is searched for repeatedly for a while.
  /// Output: the files to remove.
  std::vector<std::string> undo(Database& database, const BlobTable& blobs);

 private:
  enum class Kind { kSubmission, kClaim };
  struct Write {
    std::string key;
    Kind kind;
    std::optional<Clock::time_point> last_look;  ///< the time of the last search; set at the first one
  };

  void record(Write write);

  mutable std::mutex mutex_;
  std::vector<Write> writes_;
};

}  // namespace remesh::server::jobs
