// Tests the client against a server that answers as each test says.
#include "api/cli/remote.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "api/cli/failure.h"
#include "core/base/error.h"
#include "core/io/gzip.h"

namespace remesh::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Seen {
  std::string method, target, body;
  httplib::Headers headers;

  std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? "" : found->second;
  }
};

/// A server that answers what `answer` says, and records the requests.
class StubServer {
 public:
  using Answer = std::function<void(const Seen&, httplib::Response&)>;

  explicit StubServer(Answer answer) : answer_(std::move(answer)) {
    const auto handle = [this](const httplib::Request& request, httplib::Response& response) {
      const std::lock_guard lock(mutex_);
      seen_.push_back({request.method, request.target, request.body, request.headers});
      answer_(seen_.back(), response);
    };
    server_.Post(".*", handle).Get(".*", handle).Delete(".*", handle);
    port_ = server_.bind_to_any_port("127.0.0.1");
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();
  }
  ~StubServer() {
    server_.stop();
    thread_.join();
  }
  StubServer(const StubServer&) = delete;
  StubServer& operator=(const StubServer&) = delete;

  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }
  std::vector<Seen> seen() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }
  /// Returns the method and the target of each request so far, as in "GET /v1/jobs/7".
  std::vector<std::string> asked() const {
    std::vector<std::string> all;
    for (const Seen& one : seen()) all.push_back(one.method + " " + one.target);
    return all;
  }

 private:
  const Answer answer_;
  httplib::Server server_;
  mutable std::mutex mutex_;
  std::vector<Seen> seen_;
  int port_ = 0;
  std::thread thread_;
};

void reply(httplib::Response& response, int status, const std::string& body) {
  response.status = status;
  response.set_content(body, "application/json");
}

/// Returns the answers of a server with one job, 7, that succeeds. `before` may answer a request itself, and then
/// returns true.
StubServer::Answer job_that_succeeds(std::function<bool(const Seen&, httplib::Response&)> before) {
  return [before = std::move(before)](const Seen& seen, httplib::Response& response) {
    if (before(seen, response)) return;
    if (seen.method == "POST") return reply(response, 202, R"({"id": "7"})");
    if (seen.target.ends_with("/jobs/7")) return reply(response, 200, R"({"state": "succeeded"})");
    if (seen.target.ends_with("/result")) return reply(response, 200, "the mesh");
    if (seen.target.ends_with("/report")) return reply(response, 200, R"({"a": "report"})");
    reply(response, 404, "");
  };
}

bool nothing_before(const Seen&, httplib::Response&) { return false; }

RemoteJob job_for(const StubServer& server) {
  RemoteJob job;
  job.server = server.url();
  job.mesh = "v 0 0 0\n";
  return job;
}

RemoteAnswer run(RemoteJob job) {
  RunControl control;
  return Remote(std::move(job)).run(control);
}

RemoteError refusal_of(RemoteJob job) {
  try {
    run(std::move(job));
  } catch (const RemoteError& error) {
    return error;
  }
  ADD_FAILURE() << "no error";
  return RemoteError(0, "", "");
}

TEST(remote, a_refusal_for_want_of_a_key_says_where_it_is_taken_from) {
  for (const char* body : {R"({"code": "unauthorized", "detail": "a key is needed"})", "not JSON"}) {
    const StubServer server([&](const Seen&, httplib::Response& response) { reply(response, 401, body); });
    EXPECT_THAT(refusal_of(job_for(server)).what(), HasSubstr("REMESH_API_KEY"));
  }
}

TEST(remote, a_job_is_sent_watched_and_fetched_where_the_url_says) {
  const StubServer server(job_that_succeeds(nothing_before));
  RemoteJob job = job_for(server);
  job.server += "/behind/proxy/";
  job.wants_report = true;
  job.options = {{"refine", "false"}, {"barriers", "object,a&b=c +"}};
  const RemoteAnswer answer = run(job);
  EXPECT_EQ(answer.mesh, "the mesh");
  EXPECT_EQ(answer.report, "{\"a\": \"report\"}\n");
  EXPECT_THAT(server.asked(), ElementsAre("POST /behind/proxy/v1/jobs?refine=false&barriers=object%2Ca%26b%3Dc%20%2B",
                                          "GET /behind/proxy/v1/jobs/7", "GET /behind/proxy/v1/jobs/7/result",
                                          "GET /behind/proxy/v1/jobs/7/report"));
}

TEST(remote, what_is_known_of_the_mesh_and_wanted_of_the_answer_stands_in_headers) {
  const StubServer server(job_that_succeeds(nothing_before));
  RemoteJob job = job_for(server);
  RunControl control;
  const std::string compressed = gzip(job.mesh, control);
  job.mesh = compressed;
  job.api_key = "a-key";
  job.content_type = "model/obj";
  job.content_encoding = "gzip";
  job.accept = "model/stl";
  EXPECT_EQ(run(job).report, "");
  const std::vector<Seen> seen = server.seen();
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0].body, "v 0 0 0\n") << "what the server makes of it";
  EXPECT_EQ(seen[0].header("Content-Type"), "model/obj");
  EXPECT_EQ(seen[0].header("Content-Encoding"), "gzip");
  EXPECT_EQ(seen[0].header("Accept"), "model/stl");
  for (const Seen& one : seen) EXPECT_EQ(one.header("X-API-Key"), "a-key") << one.target;
}

TEST(remote, a_server_without_room_is_asked_again_for_the_same_job) {
  int refusals = 0;
  const StubServer server(job_that_succeeds([&](const Seen& seen, httplib::Response& response) {
    if (seen.method != "POST" || refusals == 2) return false;
    reply(response, ++refusals == 1 ? 503 : 429, "");
    return true;
  }));
  EXPECT_EQ(run(job_for(server)).mesh, "the mesh");
  const std::vector<Seen> seen = server.seen();
  ASSERT_EQ(seen.size(), 5u);
  EXPECT_NE(seen[0].header("Idempotency-Key"), "");
  EXPECT_EQ(seen[1].header("Idempotency-Key"), seen[0].header("Idempotency-Key"));
  EXPECT_EQ(seen[2].header("Idempotency-Key"), seen[0].header("Idempotency-Key"));
  run(job_for(server));
  EXPECT_NE(server.seen()[5].header("Idempotency-Key"), seen[0].header("Idempotency-Key")) << "of another job";
}

TEST(remote, a_refusal_is_the_servers_in_its_words_with_the_place) {
  const StubServer server([](const Seen&, httplib::Response& response) {
    reply(response, 422, R"({"code": "invalid_mesh", "detail": "no faces", "line": 12})");
  });
  const RemoteError error = refusal_of(job_for(server));
  EXPECT_EQ(error.status, 422);
  EXPECT_EQ(error.code, "invalid_mesh");
  EXPECT_STREQ(error.what(), "no faces");
  EXPECT_EQ(error.line, 12u);
  EXPECT_EQ(error.byte, std::nullopt);
}

TEST(remote, a_refusal_that_is_no_problem_of_ours_is_told_by_its_status) {
  const StubServer server([](const Seen&, httplib::Response& response) { reply(response, 500, "<html>sorry</html>"); });
  const RemoteError error = refusal_of(job_for(server));
  EXPECT_EQ(error.code, "http_500");
  EXPECT_THAT(error.what(), HasSubstr("500"));
}

TEST(remote, a_job_that_failed_fails_as_its_result_says) {
  const StubServer server(job_that_succeeds([](const Seen& seen, httplib::Response& response) {
    if (seen.target == "/v1/jobs/7") return reply(response, 200, R"({"state": "failed"})"), true;
    if (seen.target != "/v1/jobs/7/result") return false;
    reply(response, 422, R"({"code": "empty_mesh", "detail": "there is no face", "byte": 84})");
    return true;
  }));
  const RemoteError error = refusal_of(job_for(server));
  EXPECT_EQ(error.code, "empty_mesh");
  EXPECT_EQ(error.byte, 84u);
}

TEST(remote, what_the_server_says_of_a_running_job_is_the_progress) {
  // The second look at the job finds what the first one told.
  std::string shown;
  int looks = 0;
  std::function<std::string()> progress;
  const StubServer server(job_that_succeeds([&](const Seen& seen, httplib::Response& response) {
    if (seen.target != "/v1/jobs/7") return false;
    if (++looks == 2) shown = progress();
    if (looks == 2) return false;
    reply(response, 200, R"({"state": "running", "stage": "refinement", "fraction": 0.5})");
    return true;
  }));
  Remote remote(job_for(server));
  progress = [&] { return remote.progress_line(); };
  RunControl control;
  remote.run(control);
  EXPECT_EQ(shown, "[############            ]  50 % refinement");
}

TEST(remote, a_stop_cancels_the_job_at_the_server) {
  RunControl control;
  const StubServer server(job_that_succeeds([&](const Seen& seen, httplib::Response& response) {
    if (seen.target != "/v1/jobs/7" || seen.method != "GET") return false;
    control.cancel();
    reply(response, 200, R"({"state": "queued"})");
    return true;
  }));
  Remote remote(job_for(server));
  try {
    remote.run(control);
    FAIL() << "it went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kCancelled);
  }
  EXPECT_THAT(server.asked(), ElementsAre("POST /v1/jobs", "GET /v1/jobs/7", "DELETE /v1/jobs/7"));
}

TEST(remote, a_job_that_has_failed_is_not_asked_for_its_result) {
  std::string problem = R"({"status": 503, "code": "out_of_memory", "detail": "not enough memory"})";
  const StubServer server(job_that_succeeds([&](const Seen& seen, httplib::Response& response) {
    if (!seen.target.ends_with("/jobs/7")) return false;
    reply(response, 200, R"({"state": "failed", "problem": )" + problem + "}");
    return true;
  }));
  const RemoteError error = refusal_of(job_for(server));
  EXPECT_EQ(error.status, 503);
  EXPECT_EQ(error.code, "out_of_memory");
  EXPECT_EQ(error.what(), "not enough memory; the job is " + server.url() + "/v1/jobs/7");
  EXPECT_THAT(server.asked(), ElementsAre("POST /v1/jobs", "GET /v1/jobs/7"));
  problem = R"({"status": 422, "code": "invalid_mesh", "detail": "no faces", "line": 12})";
  const RemoteError bad = refusal_of(job_for(server));
  EXPECT_STREQ(bad.what(), "no faces");
  EXPECT_EQ(bad.line, 12u);
}

TEST(remote, a_job_whose_result_is_not_given_is_named) {
  const StubServer server(job_that_succeeds([](const Seen& seen, httplib::Response& response) {
    if (!seen.target.ends_with("/result")) return false;
    reply(response, 500, R"({"code": "internal", "detail": "something went wrong"})");
    return true;
  }));
  EXPECT_EQ(refusal_of(job_for(server)).what(), "something went wrong; the job is " + server.url() + "/v1/jobs/7");
}

TEST(remote, a_stop_while_the_answer_to_the_submission_is_on_its_way_cancels_that_job) {
  // At first the answer comes after the stop; then it never comes, and is asked for again under the same key.
  for (const int status : {202, 503}) {
    RunControl control;
    int submissions = 0;
    const StubServer server(job_that_succeeds([&](const Seen& seen, httplib::Response& response) {
      if (seen.method != "POST" || ++submissions > 1) return false;
      control.cancel();
      if (status == 202) return false;
      reply(response, status, "{}");
      return true;
    }));
    EXPECT_THROW(Remote(job_for(server)).run(control), Error);
    const std::vector<Seen> seen = server.seen();
    EXPECT_EQ(seen.back().method + " " + seen.back().target, "DELETE /v1/jobs/7");
    if (status == 202) continue;
    ASSERT_EQ(seen.size(), 3u);
    EXPECT_EQ(seen[1].header("Idempotency-Key"), seen[0].header("Idempotency-Key"));
  }
}

TEST(remote, what_is_no_url_is_refused_at_once) {
  for (const char* url : {"ftp://somewhere", "http://", "://"}) {
    RemoteJob job;
    job.server = url;
    try {
      const Remote remote(job);
      FAIL() << url;
    } catch (const Error& error) {
      EXPECT_EQ(exit_code(error), kMisused) << url;
    }
  }
}

}  // namespace
}  // namespace remesh::cli
