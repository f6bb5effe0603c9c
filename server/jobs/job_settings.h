/// The daemon's settings for jobs.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "api/operations.h"
#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

/// The share of the work that a daemon takes: answering requests, working on jobs, or both.
enum class Role { kServe, kWork, kBoth };

struct JobSettings {
  /// The job store: `sqlite`, a PostgreSQL URL, or `none`.
  std::string store = "none";
  std::string store_password_file;  ///< the file with the password for PostgreSQL; empty: it is in the URL
  /// The folder for SQLite's file. `auto` means the first writable one of $STATE_DIRECTORY, $XDG_STATE_HOME/remeshd,
  /// ~/.local/state/remeshd and /var/lib/remeshd; if none is writable, there are no jobs.
  std::string state_dir = "auto";
  std::string blob_dir;  ///< empty: inputs and results are stored in the database
  Role role = Role::kBoth;
  StoreRules rules;
  std::chrono::milliseconds job_timeout{3'600'000};
  /// Jobs that may wait in the whole store. The limit is approximate, since each daemon counts for itself.
  std::int64_t max_queued = 100'000;
};

/// The settings of the part that works on jobs.
struct RunnerSettings {
  std::string worker;  ///< the name of this process in the store and in the log
  api::Limits limits;
  std::size_t max_held = 1;  ///< jobs that this process works on at once
  StoreRules rules;          ///< a lease is renewed when a quarter of it has passed
  /// The longest time that the computation of one job may take.
  std::chrono::milliseconds job_timeout = JobSettings().job_timeout;
};

/// Finds the folder that `state_dir` means, and creates it if it is missing.
/// Output: empty if `state_dir` is `auto` and no folder can be written.
/// Errors: std::invalid_argument - the named folder cannot be written.
std::string find_state_dir(const std::string& state_dir);

/// Checks that the daemon will be able to write to its folders. The check creates no folder, because the user who
/// checks the configuration need not be the user who starts the daemon.
/// Errors: std::invalid_argument - a named folder cannot be written.
void check_folders(const JobSettings& settings);

/// Returns the store's address with its password replaced by asterisks.
std::string without_password(const std::string& store);

}  // namespace remesh::server::jobs
