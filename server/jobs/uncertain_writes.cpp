#include "server/jobs/uncertain_writes.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace remesh::server::jobs {
namespace {

/// After the server answers again, no earlier statement takes effect later than this.
constexpr std::chrono::minutes kLate{2};

/// Output: true if there was such a job.
bool undo_submission(Database& database, const BlobTable& blobs, const std::string& id,
                     std::vector<std::string>& files) {
  if (database.run("DELETE FROM remeshd_job WHERE id = $1 RETURNING id", {std::string_view(id)}).empty()) return false;
  for (std::string& file : blobs.remove(database, id, "1 = 1")) files.push_back(std::move(file));
  return true;
}

/// Output: as `undo_submission`.
bool undo_claim(Database& database, const std::string& worker) {
  const Rows rows = database.run(
      "UPDATE remeshd_job SET state = 'queued', token = token + 1, attempts = attempts - 1, version = version + 1, "
      "lease_ms = NULL, started_ms = NULL, worker = '', stage = 'queued', fraction = 0 "
      "WHERE state = 'running' AND worker = $1 RETURNING id",
      {std::string_view(worker)});
  if (rows.empty()) return false;
  database.announce();
  return true;
}

}  // namespace

void UncertainWrites::record(Write write) {
  const std::lock_guard lock(mutex_);
  writes_.push_back(std::move(write));
}

bool UncertainWrites::has_new() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(writes_.begin(), writes_.end(), [](const Write& write) { return !write.last_look; });
}

std::vector<std::string> UncertainWrites::undo(Database& database, const BlobTable& blobs) {
  std::vector<Write> writes;
  {
    const std::lock_guard lock(mutex_);
    writes = writes_;
  }
  std::vector<std::string> files;
  if (writes.empty()) return files;
  std::vector<std::string> settled;
  const Clock::time_point now = Clock::now();
  Transaction transaction(database);
  for (const Write& write : writes) {
    const bool is_undone = write.kind == Kind::kSubmission ? undo_submission(database, blobs, write.key, files)
                                                           : undo_claim(database, write.key);
    if (is_undone || now > write.last_look.value_or(now)) settled.push_back(write.key);
  }
  transaction.commit();
  const std::lock_guard lock(mutex_);
  for (const Write& looked_for : writes) {
    for (Write& write : writes_) {
      if (write.key == looked_for.key && !write.last_look) write.last_look = now + kLate;
    }
  }
  std::erase_if(writes_, [&](const Write& write) {
    return std::find(settled.begin(), settled.end(), write.key) != settled.end();
  });
  return files;
}

}  // namespace remesh::server::jobs
