#include "server/observe/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <shared_mutex>
#include <sstream>
#include <system_error>

#include "api/machine_limits.h"
#include "core/base/error.h"
#include "core/remesh.h"

namespace remesh::server {
namespace {

using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;
using prometheus::Histogram;

const Histogram::BucketBoundaries kSeconds{0.001, 0.005, 0.02, 0.1, 0.5, 2, 10, 60, 300};
const Histogram::BucketBoundaries kStoreSeconds{0.0005, 0.001, 0.002, 0.005, 0.01, 0.05, 0.2, 1, 5, 30};
const Histogram::BucketBoundaries kFaces{100, 1e3, 1e4, 1e5, 1e6, 1e7};

/// Makes a family of metrics.
template <class Metric>
Family<Metric>& family(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::detail::Builder<Metric>().Name(name).Help(help).Register(registry);
}

/// The max number of API keys that are counted by name. Keys beyond it, which only a file that is changed thousands of
/// times has, are counted together as "other".
constexpr std::size_t kMaxKeys = 1000;

/// Returns the label of a method. Any method that is not in the list becomes "other", because clients may send any
/// text.
std::string method_label(std::string_view method) {
  constexpr std::array<std::string_view, 8> kMethods{"GET",   "HEAD",   "POST",    "PUT",
                                                     "PATCH", "DELETE", "OPTIONS", "none"};
  return std::find(kMethods.begin(), kMethods.end(), method) != kMethods.end() ? std::string(method) : "other";
}

std::size_t open_descriptors() {
  std::error_code failure;
  const std::filesystem::directory_iterator folder("/proc/self/fd", failure);
  if (failure) return 0;
  // The open folder itself does not count.
  return static_cast<std::size_t>(std::distance(begin(folder), end(folder))) - 1;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

/// Metrics of a family that have been used before, found by their labels. The library would make a new metric for each
/// look-up, and each request needs a dozen look-ups.
template <class Metric>
class Known {
 public:
  /// Returns the metric that `make` returned for that key the first time. The reference stays valid as long as the
  /// family.
  template <class Make>
  Metric& find(std::string_view key, const Make& make) {
    {
      const std::shared_lock lock(mutex_);
      if (const auto known = by_key_.find(key); known != by_key_.end()) return *known->second;
    }
    Metric& made = make();
    const std::lock_guard lock(mutex_);
    by_key_.emplace(key, &made);
    return made;
  }

 private:
  std::shared_mutex mutex_;
  std::map<std::string, Metric*, std::less<>> by_key_;
};

/// Metrics whose values are read when they are asked for.
class Snapshot {
 public:
  void gauge(const char* name, const char* help, double value) { add<Gauge>(name, help).Set(value); }
  void counter(const char* name, const char* help, double value) { add<Counter>(name, help).Increment(value); }

  void process() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    counter("process_cpu_seconds_total", "CPU time, user and system.",
            seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime));
    gauge("process_resident_memory_bytes", "Memory in use.", static_cast<double>(api::resident_memory()));
    gauge("process_open_fds", "Open file descriptors.", static_cast<double>(open_descriptors()));
    rlimit files{};
    ::getrlimit(RLIMIT_NOFILE, &files);
    gauge("process_max_fds", "File descriptors that may be open.", static_cast<double>(files.rlim_cur));
  }

  std::vector<prometheus::MetricFamily> collect() const { return registry_.Collect(); }

 private:
  template <typename Metric>
  Metric& add(const char* name, const char* help) {
    return family<Metric>(registry_, name, help).Add({});
  }

  prometheus::Registry registry_;
};

}  // namespace

struct Metrics::Families {
  prometheus::Registry registry;
  const double start_seconds =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();

  Family<Counter>& requests =
      family<Counter>(registry, "remeshd_http_requests_total",
                      "Finished requests by status; code 499: the client left before its answer.");
  Family<Histogram>& durations = family<Histogram>(registry, "remeshd_http_request_duration_seconds",
                                                   "Time from a request's connection to its answer.");
  Family<Counter>& rejections = family<Counter>(registry, "remeshd_http_rejected_total",
                                                "Requests that a limit refused, by the code of their problem.");
  Family<Counter>& key_requests = family<Counter>(registry, "remeshd_key_requests_total",
                                                  "Finished requests by the name of their API key and their status.");
  Family<Counter>& key_seconds = family<Counter>(registry, "remeshd_key_work_seconds_total",
                                                 "Computing time of requests, by the name of their API key.");
  Family<Histogram>& stages =
      family<Histogram>(registry, "remeshd_stage_duration_seconds", "Time of each stage of the pipeline.");
  Family<Counter>& patches = family<Counter>(registry, "remeshd_patches_total", "Patches in all results.");
  Family<Counter>& jobs = family<Counter>(registry, "remeshd_jobs_total",
                                          "Jobs that have ended, the failed ones by the code of their problem.");
  Family<Counter>& job_retries =
      family<Counter>(registry, "remeshd_job_retries_total", "Jobs that went back to the queue.");
  Family<Counter>& store_errors =
      family<Counter>(registry, "remeshd_store_errors_total", "Operations on the job store that failed.");
  Family<Histogram>& store_latency =
      family<Histogram>(registry, "remeshd_store_latency_seconds", "Time of operations on the job store.");
  Histogram& input_faces = family<Histogram>(registry, "remeshd_input_faces", "Faces of input meshes.").Add({}, kFaces);
  Histogram& output_faces = family<Histogram>(registry, "remeshd_output_faces", "Faces of results.").Add({}, kFaces);
  Known<Counter> known_requests, known_patches;
  std::mutex key_mutex;
  std::set<std::string> key_names;
  Known<Histogram> known_durations, known_stages;
  Gauge& build_info =
      family<Gauge>(registry, "remeshd_build_info", "Always 1; the version is a label.").Add({{"version", version()}});
};

Metrics::Metrics() : families_(std::make_unique<Families>()) { families_->build_info.Set(1); }
Metrics::~Metrics() = default;

void Metrics::count_request(std::string_view route, std::string_view method, int status, double seconds) {
  const std::string path(route), label = method_label(method), code = std::to_string(status);
  families_->known_requests
      .find(code + ' ' + label + ' ' + path,
            [&]() -> Counter& {
              return families_->requests.Add({{"route", path}, {"method", label}, {"code", code}});
            })
      .Increment();
  families_->known_durations
      .find(path,
            [&]() -> Histogram& {
              return families_->durations.Add({{"route", path}}, kSeconds);
            })
      .Observe(seconds);
}

void Metrics::count_rejection(const std::string& reason) {
  families_->rejections.Add({{"reason", reason}}).Increment();
}

void Metrics::count_work(const api::WorkDone& done) {
  for (const auto& [stage, ms] : done.stages_ms) {
    const std::string_view name = stage;
    families_->known_stages
        .find(name,
              [&]() -> Histogram& {
                return families_->stages.Add({{"stage", std::string(name)}}, kSeconds);
              })
        .Observe(ms / 1000);
  }
  const auto count_patches = [&](const char* status, std::uint64_t patches) {
    families_->known_patches.find(status,
                                  [&]() -> Counter& {
                                    return families_->patches.Add({{"status", status}});
                                  })
        .Increment(static_cast<double>(patches));
  };
  count_patches("remeshed", done.remeshed);
  count_patches("reduced", done.reduced);
  count_patches("kept", done.kept);
  families_->input_faces.Observe(static_cast<double>(done.input_faces));
  if (done.output_faces > 0) families_->output_faces.Observe(static_cast<double>(done.output_faces));
}

void Metrics::count_key(const std::string& key, int status, double seconds) {
  std::string name = key;
  {
    const std::lock_guard lock(families_->key_mutex);
    std::set<std::string>& names = families_->key_names;
    if (names.size() < kMaxKeys) names.insert(key);
    if (names.count(key) == 0) name = "other";
  }
  families_->key_requests.Add({{"key", name}, {"code", std::to_string(status)}}).Increment();
  families_->key_seconds.Add({{"key", name}}).Increment(seconds);
}

void Metrics::count_job(std::string_view outcome, std::string_view code, int times) {
  std::map<std::string, std::string> labels{{"outcome", std::string(outcome)}};
  if (!code.empty()) labels.emplace("code", code);
  families_->jobs.Add(labels).Increment(times);
}

void Metrics::count_job_retry(std::string_view reason, int times) {
  families_->job_retries.Add({{"reason", std::string(reason)}}).Increment(times);
}

void Metrics::count_store(std::string_view op, double seconds, bool failed) {
  const std::string name(op);
  families_->store_latency.Add({{"op", name}}, kStoreSeconds).Observe(seconds);
  if (failed) families_->store_errors.Add({{"op", name}}).Increment();
}

std::string Metrics::text(const Gauges& gauges) const {
  Snapshot now;
  now.gauge("remeshd_http_connections", "Open connections.", static_cast<double>(gauges.connections));
  now.gauge("remeshd_requests_running", "Requests that compute.", static_cast<double>(gauges.running));
  now.gauge("remeshd_requests_queued", "Requests that wait for a worker.", static_cast<double>(gauges.queued));
  now.gauge("remeshd_workers", "Largest number of threads on which requests compute.", gauges.workers);
  now.gauge("remeshd_workers_busy", "Threads of requests that compute.", static_cast<double>(gauges.busy));
  now.gauge("remeshd_memory_reserved_bytes", "Memory that requests have reserved.",
            static_cast<double>(gauges.memory_reserved));
  now.gauge("remeshd_memory_waiting", "Requests and jobs that wait for memory.",
            static_cast<double>(gauges.memory_waiting));
  now.counter("remeshd_log_lines_dropped_total",
              "Log lines dropped because standard error accepted them too "
              "slowly.",
              static_cast<double>(gauges.log_lines_dropped));
  now.gauge("remeshd_ready", "1 while the daemon accepts new work, otherwise 0.", gauges.is_ready ? 1 : 0);
  if (gauges.has_jobs) {
    now.gauge("remeshd_jobs_queued", "Jobs that wait for a worker, in the whole store.",
              static_cast<double>(gauges.jobs_queued));
    now.gauge("remeshd_jobs_running", "Jobs that are running, in the whole store.",
              static_cast<double>(gauges.jobs_running));
    now.gauge("remeshd_job_oldest_queued_seconds", "How long the oldest waiting job has waited.",
              gauges.job_oldest_queued_s);
    now.gauge("remeshd_jobs_stored_bytes", "Bytes of the inputs and results of jobs, in the whole store.",
              static_cast<double>(gauges.jobs_stored_bytes));
  }
  now.gauge("process_start_time_seconds", "Start of the process since the epoch.", families_->start_seconds);
  now.process();

  std::ostringstream out;
  const prometheus::TextSerializer serializer;
  serializer.Serialize(out, families_->registry.Collect());
  serializer.Serialize(out, now.collect());
  return out.str();
}

}  // namespace remesh::server
