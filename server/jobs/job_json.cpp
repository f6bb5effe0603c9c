#include "server/jobs/job_json.h"

#include <array>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>

#include "api/json_writer.h"
#include "api/quoting.h"

namespace remesh::server::jobs {
namespace {

/// Formats a time as in RFC 3339, in UTC.
std::string time_text(std::int64_t ms) {
  const std::time_t seconds = ms / 1000;
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text.data() + length, text.size() - length, ".%03dZ", static_cast<int>(ms % 1000));
  return text.data();
}

void write_time(api::JsonWriter& json, std::string_view name, const std::optional<std::int64_t>& ms) {
  json.member(name, ms ? std::optional(time_text(*ms)) : std::nullopt);
}

void write_links(api::JsonWriter& json, const std::string& id, const JobLinks& links) {
  const std::string path = job_path(id);
  const std::string self = links.prefix + path;
  json.object("links", [&] {
    json.member("self", self);
    for (const char* name : {"result", "report"}) json.member(name, self + "/" + name);
    const std::string token = links.token_for ? links.token_for(path + "/events") : "";
    json.member("events", self + "/events" + (token.empty() ? "" : "?token=" + token));
  });
}

void write_job(api::JsonWriter& json, const JobRecord& job, const JobLinks& links) {
  json.member("id", job.id);
  json.member("state", state_name(job.state));
  json.member("stage", job.state == JobState::kRunning ? std::optional(job.stage) : std::nullopt);
  json.member("fraction", job.state == JobState::kQueued ? 0 : job.fraction);
  json.member("attempts", static_cast<std::uint64_t>(job.attempts));
  write_time(json, "created_at", job.created_ms);
  write_time(json, "started_at", job.started_ms);
  write_time(json, "finished_at", job.finished_ms);
  write_time(json, "expires_at", job.expires_ms);
  json.key("problem");
  const std::string_view problem = trim(api::cut(job.problem, '\n').first);
  nlohmann::json::accept(problem) ? json.raw(problem) : json.null();  // a damaged one must not damage the list
  write_links(json, job.id, links);
}

}  // namespace

std::string job_json(const JobRecord& job, const JobLinks& links) {
  api::JsonWriter json;
  json.object([&] { write_job(json, job, links); });
  return json.take();
}

std::string jobs_json(const std::vector<JobRecord>& jobs, const JobLinks& links) {
  api::JsonWriter json;
  json.object([&] { json.objects("jobs", jobs, [&](const JobRecord& job) { write_job(json, job, links); }); });
  return json.take();
}

bool is_problem(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  return json.is_object() && (!json.contains("code") || json["code"].is_string());
}

std::string problem_code(std::string_view problem) {
  if (!is_problem(problem)) return "";
  return nlohmann::json::parse(problem).value("code", "");
}

std::string job_path(const std::string& id) { return "/v1/jobs/" + id; }

}  // namespace remesh::server::jobs
