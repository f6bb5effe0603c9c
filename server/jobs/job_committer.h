/// Writes the outcomes of jobs to the store, in a thread of its own, so that the next job need not wait for the store.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <thread>

#include "server/jobs/lease_keeper.h"

namespace remesh::server::jobs {

class JobCommitter {
 public:
  using Release = std::function<void(const std::shared_ptr<ActiveJob>&)>;

  /// Input: `release` - called with each job that has ended in this process.
  JobCommitter(JobStore& store, Metrics& metrics, Release release)
      : store_(store), metrics_(metrics), release_(std::move(release)) {}

  void start() {
    thread_ = std::thread([this] { commit_until_joined(); });
  }
  /// Takes a job whose outcome is known.
  void add(std::shared_ptr<ActiveJob> job);
  /// The number of outcomes that wait for the store.
  std::size_t waiting() const;
  /// From now on an outcome is dropped if the store does not take it at once. Another worker will repeat its job.
  void begin_stop() { stopping_ = true; }
  /// Commits the waiting outcomes, and ends the thread.
  void join();

 private:
  void commit_until_joined();
  /// Output: false if the store did not answer and the commit should be tried again.
  bool commit(ActiveJob& job);

  JobStore& store_;
  Metrics& metrics_;
  const Release release_;
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<ActiveJob>> computed_;
  std::condition_variable changed_;
  bool may_end_ = false;
  std::thread thread_;
};

}  // namespace remesh::server::jobs
