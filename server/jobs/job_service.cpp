#include "server/jobs/job_service.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/http/connection.h"
#include "server/http/memory_files.h"
#include "server/jobs/sql_store.h"
#include "server/observe/log.h"

namespace remesh::server::jobs {
namespace {

/// Logs when the store stops answering and when it answers again, without filling the log meanwhile.
class OutageLog {
 public:
  /// At most one warning is written in this period.
  static constexpr std::chrono::minutes kPeriod{1};

  /// Records the outcome of a call of the store.
  /// Input: `error` - null if the call succeeded.
  void record(std::string_view op, const StoreError* error);

 private:
  std::mutex mutex_;
  bool is_away_ = false;     ///< a warning was written, and the store has not answered since then
  std::int64_t failed_ = 0;  ///< number of calls that failed since the last warning
  Clock::time_point next_warning_{};
};

void OutageLog::record(std::string_view op, const StoreError* error) {
  const std::lock_guard lock(mutex_);
  if (error == nullptr) {
    if (std::exchange(is_away_, false)) log::write(log::Level::kInfo, "the job store answers again");
    return;
  }
  ++failed_;
  const Clock::time_point now = Clock::now();
  if (now < next_warning_) return;
  is_away_ = true;
  next_warning_ = now + kPeriod;
  log::write(log::Level::kWarning, "the job store fails",
             {{"op", std::string(op)}, {"error", std::string(error->what())}, {"failed", std::exchange(failed_, 0)}});
}

constexpr std::chrono::milliseconds kLookAtJobs{1000};
constexpr std::chrono::milliseconds kMaxBetweenUpkeeps{5000};
/// How often the store is written to even without other work. The write stores the present time.
constexpr std::chrono::seconds kTouch{60};
/// How often the bytes of all stored jobs are added up, for the metrics.
constexpr std::chrono::seconds kBetweenSums{5};
/// How long a stopping daemon waits for its last calls of the store, which give jobs back. After that time, these calls
/// end even if the store does not answer.
constexpr std::chrono::milliseconds kLastCalls{1400};

/// The folder of SQLite's file if it is in memory, else empty.
std::string memory_folder(const JobSettings& settings) {
  if (settings.store != "sqlite") return {};
  std::string folder = find_state_dir(settings.state_dir);
  return is_memory_folder(folder) ? folder : std::string();
}

}  // namespace

std::unique_ptr<JobStore> open_store(const JobSettings& settings, Metrics& metrics) {
  if (settings.store == "none") return nullptr;
  std::unique_ptr<DatabaseDriver> driver;
  if (settings.store == "sqlite") {
    const std::string folder = find_state_dir(settings.state_dir);
    if (folder.empty()) {
      log::write(log::Level::kWarning, "no folder for jobs can be written to, so this server accepts no jobs",
                 {{"set", std::string("--state-dir or --store")}});
      return nullptr;
    }
    driver = make_sqlite_driver(folder + "/jobs.sqlite");
  } else {
    driver = make_postgres_driver(settings.store, settings.rules.timeout, settings.store_password_file);
  }
  std::unique_ptr<BlobFolder> folder;
  if (!settings.blob_dir.empty()) folder = std::make_unique<BlobFolder>(settings.blob_dir);
  return std::make_unique<SqlStore>(
      std::move(driver), settings.rules, std::move(folder),
      [&metrics, outage = std::make_shared<OutageLog>()](std::string_view op, double seconds, const StoreError* error) {
        metrics.count_store(op, seconds, error != nullptr);
        outage->record(op, error);
      });
}

JobService::JobService(std::unique_ptr<JobStore> store, const JobSettings& settings, RunnerSettings runner,
                       WorkerPool& pool, RequestRegistry& registry, MemoryBudget& memory, Metrics& metrics,
                       KeepOperation operation)
    : store_(std::move(store)),
      settings_(settings),
      are_blobs_in_memory_(!settings.blob_dir.empty() && is_memory_folder(settings.blob_dir)),
      memory_folder_(memory_folder(settings)),
      memory_(memory),
      metrics_(metrics),
      runner_(*store_, pool, registry, memory, metrics, std::move(operation), std::move(runner)) {}

void JobService::start() {
  try {
    store_->probe();
  } catch (const StoreUnusable&) {
    throw;
  } catch (const StoreError&) {
    // The store may come later, and until then the daemon is not ready.
  }
  looks_.emplace(kLookAtJobs, [this] { look_after(); });
  if (settings_.role != Role::kServe) runner_.start();
}

void JobService::stop() {
  if (std::exchange(is_stopped_, true)) return;
  store_->end_calls_at(Clock::now() + kLastCalls);
  runner_.stop();
  looks_.reset();
}

QueueStatistics JobService::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

void JobService::remove(const std::string& id) {
  if (store_->cancel(id)) {
    metrics_.count_job(state_name(JobState::kCancelled));
    runner_.drop(id);
  } else if (store_->discard(id)) {
    metrics_.count_job(state_name(JobState::kExpired));
  }
}

/// Writes to the store. If the store is full, upkeep continues, because its next steps make room.
void JobService::touch() {
  try {
    store_->probe();
  } catch (const StoreFull&) {
    // The store's observer has logged the error.
  }
}

void JobService::look_after() {
  try {
    const Clock::time_point now = Clock::now();
    if (!store_->is_well() || now >= next_touch_) {
      touch();
      next_touch_ = now + kTouch;
    }
    if (now >= next_upkeep_) {
      next_upkeep_ = now + std::min(kMaxBetweenUpkeeps, settings_.rules.lease / 8);
      tell(store_->upkeep());
    }
    if (now >= next_sum_) {
      next_sum_ = now + kBetweenSums;
      stored_bytes_ = store_->stored_bytes();
      memory_.record_stored(bytes_in_memory());
    }
    const QueueStatistics statistics = store_->statistics();
    const std::lock_guard lock(mutex_);
    statistics_ = statistics;
  } catch (const StoreError&) {
    // The store's observer has logged the error.
  } catch (const DataError& error) {
    log::write(log::Level::kError, "the job store holds damaged data", {{"error", std::string(error.what())}});
  }
}

std::uint64_t JobService::bytes_in_memory() const {
  std::uint64_t bytes = are_blobs_in_memory_ ? stored_bytes_.load() : 0;
  if (memory_folder_.empty()) return bytes;
  for (const char* name : {"/jobs.sqlite", "/jobs.sqlite-wal"}) {
    std::error_code none;
    const std::uintmax_t size = std::filesystem::file_size(memory_folder_ + name, none);
    if (!none) bytes += size;
  }
  return bytes;
}

void JobService::tell(const Upkeep& done) {
  metrics_.count_job_retry("worker_crashed", done.retried);
  metrics_.count_job("failed", "worker_crashed", done.crashed);
  metrics_.count_job("failed", "timeout", done.timed_out);
  metrics_.count_job("failed", "internal", done.damaged);
  metrics_.count_job("expired", "", done.expired);
  if (done.retried + done.crashed > 0) {
    log::write(log::Level::kWarning, "workers crashed or stopped while they had jobs",
               {{"retried", std::int64_t{done.retried}}, {"failed", std::int64_t{done.crashed}}});
  }
  if (done.damaged > 0) {
    log::write(log::Level::kError, "jobs failed because their rows in the store were damaged",
               {{"failed", std::int64_t{done.damaged}}});
  }
  if (!done.error.empty() && Clock::now() >= next_complaint_) {
    next_complaint_ = Clock::now() + OutageLog::kPeriod;
    log::write(log::Level::kError, "the job store holds damaged data", {{"error", done.error}});
  }
  if (done.retried > 0) runner_.wake();
}

}  // namespace remesh::server::jobs
