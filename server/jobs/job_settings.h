/// What the daemon is told about jobs.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

/// What a daemon does of the work: answering, working on jobs, or both.
enum class Role { kServe, kWork, kBoth };

struct JobSettings {
  /// `sqlite`, a PostgreSQL URL, or `none`.
  std::string store = "none";
  /// Where SQLite's file goes. `auto`: the first of $STATE_DIRECTORY, $XDG_STATE_HOME/remeshd, ~/.local/state/remeshd,
  /// /var/lib/remeshd that can be written; without one there are no jobs.
  std::string state_dir = "auto";
  std::string blob_dir;  ///< empty: inputs and results go into the store
  Role role = Role::kBoth;
  StoreRules rules;
  std::chrono::milliseconds job_timeout{3'600'000};
  std::int64_t max_queued =
      100'000;  ///< jobs that may wait, in the whole store; about, since daemons count for themselves
};

/// The folder that `state_dir` means, made where it is missing; empty where none can be written.
/// Errors: std::invalid_argument - a folder that was named cannot be.
std::string find_state_dir(const std::string& state_dir);

/// Whether the start would find its folders. Makes none: whoever checks need not be who starts.
/// Errors: std::invalid_argument - one that was named cannot be written.
void check_folders(const JobSettings& settings);

/// The store's address without its password.
std::string without_password(const std::string& store);

}  // namespace remesh::server::jobs
