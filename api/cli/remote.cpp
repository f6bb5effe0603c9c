#include "api/cli/remote.h"

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>
#include <utility>

#include "api/cli/http_client.h"
#include "api/cli/progress_bar.h"
#include "api/quoting.h"

namespace remesh::cli {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr std::chrono::seconds kPatience{120};
constexpr std::chrono::milliseconds kFirstPoll{100};
constexpr std::chrono::milliseconds kSlowestPoll{1000};

Error no_url(const std::string& text) {
  return Error(Code::kInvalidOption, Stage::kRead, text + " is not an http or https URL").for_option("server");
}

/// Splits a URL into the part that the HTTP client needs and the path: "http://host:80", "/path".
/// Errors: kInvalidOption - another scheme, or no host.
std::pair<std::string, std::string> split_url(std::string url) {
  if (url.find("://") == std::string::npos) url.insert(0, "http://");
  const std::size_t host = url.find("://") + 3;
  const std::size_t path = std::min(url.find('/', host), url.size());
  if ((!url.starts_with("http://") && !url.starts_with("https://")) || host == path) throw no_url(url);
  std::string rest = url.substr(path);
  while (!rest.empty() && rest.back() == '/') rest.pop_back();
  return {url.substr(0, path), rest};
}

/// Finds the origin in a summary, which has the form `..., origin=1 2 3`.
std::string origin_in(const std::string& summary) {
  constexpr std::string_view kName = ", origin=";
  const std::size_t at = summary.find(kName);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + kName.size();
  return summary.substr(begin, summary.find(',', begin) - begin);
}

std::string random_key() {
  std::random_device device;
  std::string key = "remesh";
  for (int i = 0; i < 4; ++i) key += "-" + std::to_string(device());
  return key;
}

RemoteError problem_of(int status, const json& problem) {
  const std::string code = "http_" + std::to_string(status);
  const std::string remark = status == 401 ? "; the API key is read from the environment variable REMESH_API_KEY" : "";
  const std::string detail = "the server answers " + std::to_string(status);
  if (!problem.is_object()) return {status, code, detail + remark};
  RemoteError error(status, problem.value("code", code), problem.value("detail", detail) + remark);
  if (problem.contains("line")) error.line = problem["line"].get<std::uint64_t>();
  if (problem.contains("byte")) error.byte = problem["byte"].get<std::uint64_t>();
  return error;
}

RemoteError problem_of(const HttpAnswer& answer) {
  return problem_of(answer.status, json::parse(answer.body, nullptr, /*allow_exceptions=*/false));
}

/// Loads the library with the HTTP client, which stays loaded. It lies beside the program, or where packages have it.
/// Errors: RemoteError - it is missing; kInvalidOption - `server` is not a URL.
std::unique_ptr<HttpClient> new_http_client(const std::string& server, const std::string& url) {
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  void* library = ::dlopen((folder / "remesh_http.so").c_str(), RTLD_NOW);
  if (library == nullptr) library = ::dlopen((folder / "../lib/remesh/remesh_http.so").c_str(), RTLD_NOW);
  void* const function = library != nullptr ? ::dlsym(library, "remesh_new_http_client") : nullptr;
  if (function == nullptr) throw RemoteError(0, "server_unreachable", std::string("no HTTP client: ") + ::dlerror());
  std::unique_ptr<HttpClient> client(reinterpret_cast<NewHttpClient*>(function)(server.c_str()));
  if (client == nullptr) throw no_url(url);
  return client;
}

}  // namespace

class Remote::Client {
 public:
  explicit Client(RemoteJob job)
      : job_(std::move(job)), url_(split_url(job_.server)), http_(new_http_client(url_.first, job_.server)) {}

  RemoteAnswer run(const RunControl& control) {
    const std::string path = submit(control);
    std::optional<RemoteError> failure;
    RemoteAnswer answer;
    try {
      failure = wait_until_ended(path, control);
      if (!failure) {
        HttpAnswer result = fetch_answer(path + "/result", control);
        answer.summary = std::move(result.summary);
        answer.origin = origin_in(answer.summary);
        answer.mesh = std::move(result.body);
      }
      if (!failure && job_.wants_report) answer.report = fetch(path + "/report", control) + "\n";
    } catch (const RemoteError& error) {
      throw with_job(error, path);  // the job continues at the server, or its result is there
    } catch (const Error&) {
      cancel(path);  // the caller asked us to stop, so the server need not continue
      throw;
    }
    // An error of the mesh is reported alone. An error of the server names the job, so that the user can ask about the
    // job.
    if (failure) throw failure->status < 500 ? *failure : with_job(*failure, path);
    return answer;
  }

  std::string progress_line() const {
    const std::lock_guard lock(mutex_);
    return progress_bar(fraction_) + stage_;
  }

 private:
  HttpRequest request(const std::string& method, const std::string& path) const {
    HttpRequest request;
    request.method = method;
    request.target = url_.second + path;
    if (!job_.api_key.empty()) request.headers.emplace_back("X-API-Key", job_.api_key);
    return request;
  }

  /// Asks until there is an answer that is not due to a missing server.
  /// Errors: RemoteError; kCancelled.
  HttpAnswer insist(const HttpRequest& request, const RunControl& control) {
    Clock::time_point deadline = Clock::now() + kPatience;
    for (std::chrono::milliseconds pause = kFirstPoll;; pause = std::min(2 * pause, kSlowestPoll)) {
      control.check();
      HttpAnswer answer = http_->ask(request);
      const bool is_answered = answer.status != 0;
      if (is_answered && answer.status != 503 && answer.status != 502 && answer.status != 429) return answer;
      if (Clock::now() > deadline) {
        if (is_answered) throw problem_of(answer);
        throw RemoteError(0, "server_unreachable", job_.server + ": " + answer.failure);
      }
      tell(is_answered ? "waiting for room" : "waiting for the server", 0);
      std::this_thread::sleep_for(pause);
    }
  }

  std::string submit(const RunControl& control) {
    tell("sending", 0);
    std::string path = "/v1/jobs";
    char separator = '?';
    const auto encoded = [](std::string_view text) { return api::percent_encoded(text, "-_.~,"); };
    for (const auto& [name, value] : job_.options) {
      path += std::exchange(separator, '&') + encoded(name) + "=" + encoded(value);
    }
    HttpRequest post = request("POST", path);
    // The key is the same at each attempt, so a job whose answer was lost is not created twice.
    post.headers.emplace_back("Idempotency-Key", random_key());
    if (!job_.accept.empty()) post.headers.emplace_back("Accept", job_.accept);
    if (!job_.content_encoding.empty()) post.headers.emplace_back("Content-Encoding", job_.content_encoding);
    post.content_type = job_.content_type.empty() ? "application/octet-stream" : job_.content_type;
    post.body = job_.mesh;
    control.check();
    try {
      const HttpAnswer answer = insist(post, control);
      if (answer.status != 202) throw problem_of(answer);
      return path_of_job(answer);
    } catch (const Error&) {
      // The user asked to stop before there was an answer, which may already be under way. Sending again with the same
      // key tells which job it was.
      if (const HttpAnswer answer = http_->ask(post); answer.status == 202) cancel(path_of_job(answer));
      throw;
    }
  }

  static std::string path_of_job(const HttpAnswer& answer) {
    return "/v1/jobs/" + json::parse(answer.body).at("id").get<std::string>();
  }

  void cancel(const std::string& path) { http_->ask(request("DELETE", path)); }

  RemoteError with_job(const RemoteError& error, const std::string& path) const {
    RemoteError told(error.status, error.code,
                     std::string(error.what()) + "; the job is " + url_.first + url_.second + path);
    told.line = error.line;
    told.byte = error.byte;
    return told;
  }

  /// Output: the problem with which the job has ended, if there is one.
  std::optional<RemoteError> wait_until_ended(const std::string& path, const RunControl& control) {
    for (std::chrono::milliseconds pause = kFirstPoll;; pause = std::min(pause * 3 / 2, kSlowestPoll)) {
      const json state = json::parse(fetch(path, control));
      const std::string name = state.at("state").get<std::string>();
      if (name != "queued" && name != "running") {
        const json problem = state.value("problem", json());
        if (!problem.is_object()) return std::nullopt;
        return problem_of(problem.value("status", 500), problem);
      }
      tell(name == "running" && state.at("stage").is_string() ? state.at("stage").get<std::string>() : name,
           state.value("fraction", 0.0));
      std::this_thread::sleep_for(pause);
    }
  }

  HttpAnswer fetch_answer(const std::string& path, const RunControl& control) {
    HttpAnswer answer = insist(request("GET", path), control);
    if (answer.status != 200) throw problem_of(answer);
    return answer;
  }
  std::string fetch(const std::string& path, const RunControl& control) { return fetch_answer(path, control).body; }

  void tell(const std::string& stage, double fraction) {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    fraction_ = fraction;
  }

  const RemoteJob job_;
  const std::pair<std::string, std::string> url_;
  const std::unique_ptr<HttpClient> http_;
  mutable std::mutex mutex_;
  std::string stage_ = "queued";
  double fraction_ = 0;
};

Remote::Remote(RemoteJob job) : client_(std::make_unique<Client>(std::move(job))) {}
Remote::~Remote() = default;
RemoteAnswer Remote::run(const RunControl& control) { return client_->run(control); }
std::string Remote::progress_line() const { return client_->progress_line(); }

}  // namespace remesh::cli
