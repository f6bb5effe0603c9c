/// The whole daemon: its routes, the worker pool behind them, the listeners in front of them, and its shutdown.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "server/config.h"
#include "server/http/api_keys.h"
#include "server/http/route.h"
#include "server/http/spool.h"
#include "server/http_server.h"
#include "server/jobs/job_routes.h"
#include "server/jobs/job_service.h"
#include "server/observe/metrics.h"
#include "server/work/memory_budget.h"
#include "server/work/memory_watch.h"
#include "server/work/request_registry.h"
#include "server/work/work.h"
#include "server/work/worker_pool.h"

namespace remesh::server {

/// The functions that the daemon serves. Tests replace them with stubs.
struct Operations {
  Operation remesh = api::run_remesh;
  Operation analyze = api::run_analyze;
  Operation compare = api::run_compare;
  std::function<api::Response(const api::Limits&)> capabilities = api::capabilities;
  std::function<api::Response()> openapi = api::openapi;
  jobs::KeepOperation remesh_to_keep = api::run_remesh_to_keep;
};

class Daemon {
 public:
  Daemon(const Config& config, Operations operations);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Binds the addresses and accepts connections.
  /// Errors: std::runtime_error - an address cannot be bound.
  void start();
  int port() const { return http_.port(); }
  std::size_t key_count() const { return keys_.count(); }
  bool keeps_jobs() const { return jobs_ != nullptr; }
  int ops_port() const { return ops_ ? ops_->port() : 0; }

  /// Reads the API keys again.
  /// Errors: std::invalid_argument - see ApiKeys; the old keys then stay in force.
  void reload_keys() { keys_.reload(); }

  /// Reports not ready and accepts no new work from now on. Work that was accepted before is finished.
  void begin_drain();
  /// True if no request and no job is being worked on.
  bool is_idle() const { return http_.active_requests() == 0 && (!jobs_ || jobs_->is_idle()); }
  /// Cancels the requests that still run, which are answered with the code `draining`. Then closes all connections and
  /// waits for their end.
  void stop();

 private:
  std::vector<Route> routes();
  std::vector<Route> ops_routes();
  std::unique_ptr<jobs::JobService> make_jobs();
  HttpSettings http_settings();
  /// The folder for large answers to slow readers.
  std::string spool_folder() const;
  /// The rules for the listener at this address. There are none if API keys are required.
  std::optional<SiteRules> site_rules(const Address& address) const;
  /// True if a request to remesh becomes a job. Without a job store the client's preference is ignored, and the request
  /// is answered at once.
  bool makes_job(const RequestHead& head) const;
  Admission admit_work(const RequestHead& head);
  /// The contract, with the URL of the server as the client sees it.
  Response show_contract(const Call& call) const;
  Response show_metrics() const;
  Response readiness() const;
  Response show_request(const Call& call);
  Response cancel_request(const Call& call);
  Response follow_request(const Call& call);

  const Config config_;
  const Operations operations_;
  const WorkLimits work_limits_;
  const Workplace work_;
  std::atomic<bool> draining_{false};
  ApiKeys keys_;
  Metrics metrics_;
  RequestRegistry registry_;
  MemoryBudget memory_;
  MemoryWatch memory_watch_;
  Spool spool_;
  jobs::KeptAnswers kept_;
  std::unique_ptr<jobs::JobService> jobs_;  ///< null without a store; outlives the pool that runs its work
  jobs::JobRoutes job_routes_;
  WorkerPool pool_;
  HttpServer http_;
  std::unique_ptr<HttpServer> ops_;
};

}  // namespace remesh::server
