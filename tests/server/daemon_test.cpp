/// Tests the whole daemon in this process, on a free port, with a stub in place of the geometry.
#include "server/daemon.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "server/http/memory_files.h"
#include "server/jobs/job_request.h"
#include "server/jobs/sql_store.h"
#include "tests/server/stub_daemon.h"
#include "tests/support/time_limit.h"

namespace remesh::server {
namespace {

class daemon : public StubDaemon {
 protected:
  /// Sends a request again until it is worked on: where its time is short, a busy machine may start no thread in it.
  Answer once_begun(const std::string& body) {
    Answer answer;
    EXPECT_TRUE(eventually([&] { return (answer = post(port_, "/v1/remesh", body)).status != 503; }));
    return answer;
  }
};

TEST_F(daemon, a_request_reaches_the_operation_as_it_was_sent) {
  start();
  const Answer answer = post(port_, "/v1/remesh?a=1e+5&b=%20", "hello",
                             "Content-Type: application/x-www-form-urlencoded\r\nAccept: model/obj\r\n" + kIdField);
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "5 application/x-www-form-urlencoded model/obj a=1e+5 b= ");
  EXPECT_EQ(answer.header("X-Request-Id"), kId);
  EXPECT_EQ(answer.header("Connection"), "keep-alive");
  EXPECT_EQ(answer.header("Content-Length"), std::to_string(answer.body.size()));
}

TEST_F(daemon, the_small_routes_answer) {
  start();
  EXPECT_EQ(get(port_, "/livez").status, 200);
  EXPECT_EQ(get(port_, "/readyz").status, 200);
  EXPECT_EQ(get(port_, "/").status, 200);
  EXPECT_EQ(get(port_, "/openapi.json").body, "{}");
  EXPECT_EQ(get(port_, "/v1/capabilities").body, "1000");
  EXPECT_EQ(post(port_, "/v1/analyze", "x").status, 200);
  EXPECT_EQ(post(port_, "/v1/compare", "x").status, 200);
  EXPECT_EQ(code_of(get(port_, "/nothing")), "not_found");
  EXPECT_EQ(code_of(get(port_, "/v1/remesh")), "method_not_allowed");
  EXPECT_EQ(get(port_, "/v1/remesh").header("Allow"), "POST, OPTIONS");
  const Answer head = ask(port_, "HEAD /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(head.header("Content-Length"), "6");
}

TEST_F(daemon, http_1_0_and_chunks_are_served) {
  start();
  EXPECT_EQ(ask(port_, "GET /livez HTTP/1.0\r\n\r\n").status, 200);
  EXPECT_EQ(ask(port_,
                "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"
                "5\r\nhello\r\n0\r\n\r\n")
                .body,
            "5  ");
}

TEST_F(daemon, bad_requests_are_told_why_and_the_next_one_is_served) {
  start();
  const auto expect = [&](int status, const std::string& code, const Answer& answer) {
    EXPECT_EQ(answer.status, status) << code;
    EXPECT_EQ(code_of(answer), code);
    EXPECT_FALSE(answer.header("X-Request-Id").empty());
    EXPECT_NE(answer.body.find(answer.header("X-Request-Id")), std::string::npos);
    expect_well();
  };
  expect(422, "empty_mesh", post(port_, "/v1/remesh", ""));
  expect(422, "invalid_mesh", post(port_, "/v1/remesh", "line 3"));
  expect(500, "internal", post(port_, "/v1/remesh", "throw"));
  expect(503, "out_of_memory", post(port_, "/v1/remesh", "no memory"));
  expect(413, "body_too_large", post(port_, "/v1/remesh", std::string(1001, 'x')));
  expect(413, "body_too_large",
         ask(port_, "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10000000000\r\n\r\n"));
  expect(413, "body_too_large", ask(port_, "GET /livez HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n\r\nx"));
  expect(411, "length_required", ask(port_, "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  expect(400, "malformed_request", ask(port_, "rubbish\r\n\r\n"));
  expect(400, "malformed_request", ask(port_, "GET / HTTP/1.1\nHost: localhost\n\n"));
  expect(400, "malformed_request", post(port_, "/v1/remesh", "x", "Content-Length: 1\r\n"));
  expect(400, "malformed_request", post(port_, "/v1/remesh", "x", "Transfer-Encoding: chunked\r\n"));
  expect(414, "uri_too_long", ask(port_, "GET /" + std::string(100'000, 'a')));
  expect(431, "header_fields_too_large", ask(port_, "GET / HTTP/1.1\r\nA: " + std::string(100'000, 'a')));
}

TEST_F(daemon, a_request_that_does_not_come_to_its_end_is_told_so) {
  config_.connections.gate.head_timeout = milliseconds(300);
  start();
  for (const char* begun :
       {"POST /v1/remesh HT", "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nx"}) {
    Answer answer;
    // On a busy machine the time may be over before the client has sent anything, and then it gets no answer.
    EXPECT_TRUE(eventually([&] { return (answer = ask(port_, begun)).status != 0; }));
    EXPECT_EQ(answer.status, 408) << begun;
    EXPECT_EQ(code_of(answer), "request_timeout") << begun;
  }
}

TEST_F(daemon, an_unexpected_failure_stays_opaque) {
  start();
  const Answer answer = post(port_, "/v1/remesh", "throw");
  EXPECT_EQ((answer.head + answer.body).find("secret"), std::string::npos);
  EXPECT_EQ(post(port_, "/v1/remesh", "no memory").header("Retry-After").empty(), false);
}

TEST_F(daemon, an_upload_that_goes_on_after_its_refusal_still_gets_the_answer) {
  start();
  RawClient client(port_);
  client.send("POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 20000000\r\n\r\n");
  for (int i = 0; i < 200; ++i) client.send(std::string(10'000, 'x'));
  EXPECT_EQ(client.answer().status, 413);
}

TEST_F(daemon, a_running_request_is_shown_and_can_be_cancelled) {
  start();
  const auto client = start_blocking(kIdField);
  const Answer shown = get(port_, "/v1/requests/" + kId);
  EXPECT_EQ(shown.status, 200);
  const auto progress = nlohmann::json::parse(shown.body);
  EXPECT_EQ(progress["id"], kId);
  EXPECT_EQ(progress["stage"], "triangulation");
  // Triangulation is the part from 0.12 to 0.15 of a usual run, and half of it is done.
  EXPECT_EQ(progress["fraction"], 0.135);
  EXPECT_GE(progress["elapsed_s"], 0.0);

  EXPECT_EQ(ask(port_, "DELETE /v1/requests/" + kId + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 204);
  EXPECT_EQ(code_of(client->answer()), "cancelled");
  EXPECT_EQ(get(port_, "/v1/requests/" + kId).status, 404);
  EXPECT_EQ(ask(port_, "DELETE /v1/requests/" + kId + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 404);
  expect_well();
}

TEST_F(daemon, an_id_in_use_is_replaced_by_a_new_one) {
  config_.max_running = 2;
  start();
  const auto client = start_blocking(kIdField);
  const Answer second = post(port_, "/v1/remesh", "x", kIdField);
  EXPECT_EQ(second.status, 200);
  EXPECT_NE(second.header("X-Request-Id"), kId);
  EXPECT_EQ(second.header("X-Request-Id").size(), 32u);
  stub_.released = true;
  EXPECT_EQ(client->answer().header("X-Request-Id"), kId);
}

TEST_F(daemon, events_follow_a_request_to_its_end) {
  start();
  const auto client = start_blocking(kIdField);
  RawClient follower(port_);
  follower.send("GET /v1/requests/" + kId + "/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  std::string stream = follower.receive("event: progress\ndata: {");
  EXPECT_NE(stream.find("Content-Type: text/event-stream\r\n"), std::string::npos);
  stub_.released = true;
  stream += follower.receive();
  EXPECT_NE(stream.find("event: end\ndata: {\"id\":\"" + kId + "\""), std::string::npos) << stream;
  EXPECT_EQ(get(port_, "/v1/requests/" + kId + "/events").status, 404);
}

TEST_F(daemon, work_stops_within_100_ms_when_its_client_goes_away) {
  start();
  const auto time_to_stop = [&](const std::function<void(RawClient&)>& stop) {
    const int before = stub_.stopped;
    const auto client = start_blocking(kIdField);
    const Clock::time_point start = Clock::now();
    stop(*client);
    EXPECT_TRUE(eventually([&] { return stub_.stopped > before; }));
    const test::Seconds took = Clock::now() - start;
    EXPECT_TRUE(eventually([&] { return get(port_, "/v1/requests/" + kId).status == 404; }));
    return took;
  };
  // On a busy machine both take longer: to stop work by another request, and to notice that its client has left.
  const test::Seconds by_request = time_to_stop(
      [&](RawClient&) { ask(port_, "DELETE /v1/requests/" + kId + " HTTP/1.1\r\nHost: localhost\r\n\r\n"); });
  test::expect_best_within(milliseconds(100) + 5 * by_request,
                           [&] { return time_to_stop([](RawClient& client) { client.close(); }); });
  expect_well();
}

TEST_F(daemon, a_client_that_closes_its_sending_side_is_asked_and_gets_its_answer) {
  start();
  const auto client = start_blocking();
  client->close_sending();
  const std::string interim = "HTTP/1.1 102 Processing\r\n\r\n";
  EXPECT_EQ(client->receive(interim), interim);
  stub_.released = true;
  const Answer answer = client->answer();
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "5  ");
  EXPECT_EQ(stub_.stopped, 0);
}

TEST_F(daemon, one_that_is_half_closed_and_then_gone_stops_its_work) {
  start();
  const auto client = start_blocking();
  client->close_sending();
  client->receive("102 Processing\r\n\r\n");
  client->close();
  EXPECT_TRUE(eventually([&] { return stub_.stopped == 1; }));
  expect_well();
}

TEST_F(daemon, a_client_that_leaves_megabytes_of_its_next_request_behind_stops_its_work) {
  config_.limits.max_body = 16 << 20;
  start();
  const auto client = start_blocking();
  const std::string next = post_text("/v1/remesh", std::string(12 << 20, 'x'));
  EXPECT_TRUE(client->send(next));  // which waits until the daemon has read most of it
  client->close();
  EXPECT_TRUE(eventually([&] { return stub_.stopped == 1; }));
  expect_well();
}

TEST_F(daemon, what_was_read_ahead_is_the_next_request) {
  config_.limits.max_body = 4 << 20;
  start();
  const auto client = start_blocking();
  client->send(post_text("/v1/remesh", std::string(3 << 20, 'x')) + post_text("/v1/remesh", "third"));
  stub_.released = true;
  EXPECT_EQ(client->answer().body, "5  ");
  EXPECT_EQ(client->answer().body, std::to_string(3 << 20) + "  ");
  EXPECT_EQ(client->answer().body, "5  ");
  expect_well();
}

TEST_F(daemon, before_http_1_1_there_is_no_asking) {
  start();
  RawClient client(port_);
  client.send("POST /v1/remesh HTTP/1.0\r\nContent-Length: 5\r\n\r\nblock");
  ASSERT_TRUE(eventually([&] { return stub_.blocked == 1; }));
  client.close_sending();
  EXPECT_EQ(code_of(client.answer()), "cancelled");
  EXPECT_EQ(stub_.stopped, 1);
}

TEST_F(daemon, a_small_request_from_a_half_closed_client_is_answered_without_ado) {
  start();
  RawClient client(port_);
  client.send(post_text("/v1/remesh", "hello"));
  client.close_sending();
  EXPECT_EQ(client.answer().status, 200);
}

TEST_F(daemon, a_refusal_carries_the_id_that_the_client_sent) {
  start();
  for (const char* request : {"GET /nothing HTTP/1.1\r\nHost: localhost\r\n", "BREW / HTTP/1.1\r\nHost: localhost\r\n",
                              "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\n"}) {
    const Answer answer = ask(port_, request + kIdField + "\r\n");
    EXPECT_EQ(answer.header("X-Request-Id"), kId) << request;
    EXPECT_NE(answer.body.find(kId), std::string::npos) << request;
  }
}

TEST_F(daemon, a_full_queue_refuses_at_once_and_says_when_to_come_back) {
  start();
  std::vector<std::unique_ptr<RawClient>> taken;
  int tries = 0;
  // Returns the refusal, or nothing if the request was accepted.
  const auto submit = [&] {
    const std::string id = kId + std::to_string(++tries);
    auto client = std::make_unique<RawClient>(port_);
    client->send(post_text("/v1/remesh", "block", "X-Request-Id: " + id + "\r\n"));
    EXPECT_TRUE(eventually([&] { return client->has_input() || get(port_, "/v1/requests/" + id).status == 200; }));
    if (client->has_input()) return client->answer();
    taken.push_back(std::move(client));
    return Answer();
  };
  // One request computes, one passes it after a while, and one waits. None ends.
  ASSERT_TRUE(eventually([&] {
    submit();
    return taken.size() == 3;
  }));
  const Answer refused = submit();
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(code_of(refused), "overloaded");
  EXPECT_FALSE(refused.header("Retry-After").empty());
  const Answer early = ask(port_, "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 500\r\n\r\n");
  EXPECT_EQ(early.status, 503) << "before its body has come";
  EXPECT_EQ(get(port_, "/livez").status, 200);
  EXPECT_EQ(get(port_, "/v1/capabilities").status, 200);
  stub_.released = true;
  for (const auto& client : taken) EXPECT_EQ(client->answer().status, 200);
}

TEST_F(daemon, a_waiting_request_can_be_cancelled_and_frees_its_place) {
  start();
  const auto running = start_blocking();
  RawClient waiting(port_);
  waiting.send(post_text("/v1/remesh", "good", kIdField));
  ASSERT_TRUE(eventually([&] { return get(port_, "/v1/requests/" + kId).status == 200; }));
  EXPECT_EQ(nlohmann::json::parse(get(port_, "/v1/requests/" + kId).body)["stage"], "queued");
  EXPECT_EQ(ask(port_, "DELETE /v1/requests/" + kId + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 204);
  EXPECT_EQ(code_of(waiting.answer()), "cancelled");
  EXPECT_EQ(stub_.calls, 1);
}

TEST_F(daemon, work_past_its_time_is_stopped_with_504) {
  config_.limits.request_timeout = milliseconds(500);
  start();
  const Answer answer = once_begun("block");
  EXPECT_EQ(answer.status, 504);
  EXPECT_EQ(code_of(answer), "timeout");
  EXPECT_TRUE(eventually([&] { return stub_.stopped == 1; }));
  EXPECT_EQ(once_begun("good").status, 200);
}

TEST_F(daemon, work_that_does_not_hear_the_stop_is_answered_for) {
  config_.limits.request_timeout = milliseconds(500);
  start();
  EXPECT_EQ(once_begun("deaf").status, 504);
  stub_.released = true;
  EXPECT_EQ(once_begun("good").status, 200);
}

TEST_F(daemon, waiting_too_long_for_a_worker_is_overload_not_timeout) {
  config_.limits.request_timeout = milliseconds(3000);
  start();
  // A small request may start beyond the one place once the other has run for a second, but no third one. Being deaf,
  // these two occupy their threads also when their time is over.
  const auto running = start_blocking("", "deaf"), other = start_blocking("", "deaf");
  EXPECT_EQ(code_of(post(port_, "/v1/remesh", "good")), "overloaded");
  stub_.released = true;
}

TEST_F(daemon, slow_clients_hold_nobody_up) {
  config_.connections.gate.head_timeout = std::chrono::minutes(5);
  config_.connections.max_connections_per_address = config_.connections.max_connections;
  start();
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 200; ++i) {
    slow.push_back(std::make_unique<RawClient>(port_));
    slow.back()->send(i % 2 == 0 ? "POST /v1/re"
                                 : "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nx");
  }
  const auto running = start_blocking();
  // They stay for longer than a client waits for its answer. `./dev slow` measures how soon it comes.
  EXPECT_EQ(get(port_, "/livez").status, 200);
}

TEST_F(daemon, connections_beyond_the_limit_are_refused_with_an_answer) {
  config_.connections.max_connections = 3;
  config_.connections.gate.head_timeout = std::chrono::minutes(5);
  start();
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 3; ++i) idle.push_back(hold_connection());
  const Answer refused = get(port_, "/livez");
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(code_of(refused), "overloaded");
  idle.clear();
  EXPECT_TRUE(eventually([&] { return get(port_, "/livez").status == 200; }));
}

TEST_F(daemon, a_slow_upload_gets_the_answer_that_came_before_its_end) {
  start();
  RawClient client(port_);
  client.send("POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000000\r\n\r\n");
  // Like many clients, this one looks for an answer only when it has sent everything.
  const std::string piece(64 << 10, 'x');
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(client.send(piece)) << i;
    std::this_thread::sleep_for(milliseconds(100));
  }
  client.close_sending();
  const Answer answer = client.answer();
  EXPECT_EQ(answer.status, 413);
  EXPECT_NE(answer.body.find("longer than 1000 bytes"), std::string::npos) << answer.body;
}

TEST_F(daemon, another_content_coding_is_refused_before_its_body) {
  start();
  for (const char* coding : {"br", "gzip, gzip", "deflate"}) {
    const Answer answer =
        ask(port_, "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\nContent-Encoding: " +
                       std::string(coding) + "\r\n\r\n");
    EXPECT_EQ(answer.status, 415) << coding;
    EXPECT_EQ(code_of(answer), "unsupported_media_type");
    EXPECT_EQ(answer.header("Accept-Encoding"), "gzip");
  }
  EXPECT_EQ(post(port_, "/v1/remesh", "good", "Content-Encoding: identity\r\n").status, 200);
}

TEST_F(daemon, a_slash_too_many_is_told) {
  start();
  const Answer answer = post(port_, "/v1/remesh/", "good");
  EXPECT_EQ(answer.status, 404);
  EXPECT_NE(answer.body.find("the path would be /v1/remesh"), std::string::npos) << answer.body;
  EXPECT_EQ(get(port_, "/nowhere/").body.find("slash"), std::string::npos);
}

TEST_F(daemon, streams_of_events_tell_proxies_not_to_hold_them_back) {
  start();
  const auto running = start_blocking(kIdField);
  RawClient events(port_);
  events.send("GET /v1/requests/" + kId + "/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(Answer::parse(events.receive("\r\n\r\n")).header("X-Accel-Buffering"), "no");
  stub_.released = true;
}

TEST_F(daemon, lists_may_come_as_several_fields) {
  start();
  const Answer answer = post(port_, "/v1/remesh", "good", "Accept: text/plain\r\nAccept: model/obj\r\n");
  EXPECT_EQ(answer.body, "4  text/plain, model/obj");
}

TEST_F(daemon, the_contract_names_the_server_as_the_client_sees_it) {
  openapi_ = R"({"servers": [{"url": "/"}]})";
  config_.trusted_proxies = TrustedProxies("127.0.0.2");
  start();
  const auto contract = [&](const char* from) {
    RawClient client(port_, from);
    client.send("GET /openapi.json HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-Prefix: /mesh/\r\n\r\n");
    return client.answer().body;
  };
  EXPECT_EQ(contract("127.0.0.1"), R"({"servers": [{"url": "/"}]})");
  EXPECT_EQ(contract("127.0.0.2"), R"({"servers": [{"url": "/mesh"}]})");
}

TEST_F(daemon, the_operations_port_answers_for_health_only) {
  config_.ops_bind = Address{"127.0.0.1", 0};
  config_.connections.max_connections = 1;
  start();
  const RawClient only(port_);
  EXPECT_EQ(get(daemon_->ops_port(), "/livez").status, 200);
  EXPECT_EQ(get(daemon_->ops_port(), "/readyz").status, 200);
  EXPECT_EQ(get(daemon_->ops_port(), "/v1/capabilities").status, 404);
}

TEST_F(daemon, draining_finishes_what_runs_and_takes_nothing_new) {
  start();
  const auto running = start_blocking();
  daemon_->begin_drain();
  EXPECT_FALSE(daemon_->is_idle());
  EXPECT_EQ(get(port_, "/livez").status, 200);
  EXPECT_EQ(get(port_, "/readyz").status, 503);
  const Answer refused = post(port_, "/v1/remesh", "x");
  EXPECT_EQ(code_of(refused), "draining");
  EXPECT_FALSE(refused.header("Retry-After").empty());
  stub_.released = true;
  EXPECT_EQ(running->answer().status, 200);
  EXPECT_TRUE(eventually([&] { return daemon_->is_idle(); }));
}

TEST_F(daemon, stopping_cancels_what_is_left) {
  start();
  const auto running = start_blocking();
  const RawClient idle(port_);
  daemon_->stop();
  EXPECT_EQ(stub_.stopped, 1);
  const Answer answer = running->answer();
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(code_of(answer), "draining");
  EXPECT_THROW(RawClient{port_}, std::runtime_error);
}

TEST_F(daemon, a_port_in_use_is_an_error_not_a_second_daemon) {
  start();
  Config second = config_;
  second.bind.port = port_;
  Daemon other(second, Operations{});
  try {
    other.start();
    FAIL() << "two daemons on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("Address already in use"), std::string::npos) << error.what();
  }
  EXPECT_EQ(get(port_, "/livez").status, 200);
}

/// The daemon with a folder for jobs of its own. It does not work on them.
class daemon_with_jobs : public StubDaemon {
 protected:
  ~daemon_with_jobs() override {
    daemon_.reset();
    std::filesystem::remove_all(folder_);
  }
  void start_with_jobs(const std::filesystem::path& parent) {
    folder_ = parent / ("remeshd-service-" + new_request_id());
    std::filesystem::create_directories(folder_);
    config_.jobs.store = "sqlite";
    config_.jobs.state_dir = folder_.string();
    config_.jobs.role = jobs::Role::kServe;
    start();
  }

  std::filesystem::path folder_;
};

TEST_F(daemon_with_jobs, a_result_in_a_folder_that_another_daemon_has_is_not_there_now) {
  start_with_jobs(std::filesystem::temp_directory_path());
  const std::string file = (folder_ / "jobs.sqlite").string();
  jobs::SqlStore store(jobs::make_sqlite_driver(file), jobs::StoreRules{});
  jobs::NewJob job;
  job.id = new_request_id();
  job.request = jobs::pack_request({});
  job.body = "x";
  job.memory = 1;
  store.submit(job);
  jobs::JobOutcome outcome;
  outcome.mesh = "a mesh";
  outcome.report = "{}";
  ASSERT_TRUE(store.commit(store.claim("test", 1).value(), outcome));
  jobs::make_sqlite_driver(file)->connect()->run("UPDATE remeshd_blob SET file = 'a file'");
  const Answer answer = get(port_, "/v1/jobs/" + job.id + "/result");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(code_of(answer), "store_unavailable");
}

TEST_F(daemon_with_jobs, jobs_in_memory_take_no_more_than_half_of_the_budget) {
  if (!is_memory_folder("/dev/shm")) GTEST_SKIP() << "there is no folder in memory";
  config_.memory_budget = 1000;  // an empty file of SQLite is larger
  start_with_jobs("/dev/shm");
  EXPECT_TRUE(eventually([&] { return code_of(post(port_, "/v1/jobs", "x")) == "storage_full"; }));
}

}  // namespace
}  // namespace remesh::server
