/// Tests the real binary in a process of its own, with the real geometry.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/server/daemon_process.h"
#include "tests/server/raw_client.h"
#include "tests/server/small_meshes.h"
#include "tests/support/sanitizer.h"
#include "tests/support/time_limit.h"

namespace remesh::server {
namespace {

int run(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string problem_code(const Answer& answer) {
  const auto problem = nlohmann::json::parse(answer.body, nullptr, false);
  return problem.is_object() ? problem.value("code", "") : "";
}

TEST(end_to_end, the_small_routes_answer) {
  const DaemonProcess daemon;
  for (const char* path : {"/livez", "/readyz", "/", "/v1/capabilities", "/openapi.json"}) {
    EXPECT_EQ(get(daemon.port(), path).status, 200) << path;
  }
}

TEST(end_to_end, a_square_with_a_hole_comes_back_as_one_patch_of_eight_triangles) {
  const DaemonProcess daemon;
  const Answer answer = post(daemon.port(), "/v1/remesh?refine=false", kFrame, "Accept: application/json\r\n");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const auto result = nlohmann::json::parse(answer.body);
  EXPECT_EQ(result["mesh"]["faces"].size(), 8u);
  EXPECT_EQ(result["mesh"]["vertices"].size(), 8u);
  EXPECT_EQ(result["report"]["output"]["area"], 28.0);
  ASSERT_EQ(result["report"]["patches"].size(), 1u);
  EXPECT_EQ(result["report"]["patches"][0]["loops"], 2);
  EXPECT_EQ(result["report"]["patches"][0]["essential_vertices"], 8);
}

TEST(end_to_end, a_plain_request_is_refined) {
  const DaemonProcess daemon;
  const Answer answer = post(daemon.port(), "/v1/remesh", kFrame, "Accept: application/json\r\n");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const auto report = nlohmann::json::parse(answer.body)["report"];
  EXPECT_GT(report["output"]["faces"], 8u);
  EXPECT_NEAR(report["output"]["area"].get<double>(), 28, 1e-11);
  EXPECT_GE(report["output"]["quality"]["min_angle_deg"], 25.0);
  EXPECT_EQ(report["verified"]["quality"], true);
}

TEST(end_to_end, attempts_are_in_the_log_at_level_debug_alone) {
  for (const bool is_debug : {false, true}) {
    DaemonProcess daemon({"--log-level", is_debug ? "debug" : "info"});
    const Answer answer = post(daemon.port(), "/v1/remesh", kFrame);
    ASSERT_EQ(answer.status, 200);
    daemon.send_signal(SIGTERM);
    daemon.wait();
    const std::string log = daemon.log();
    EXPECT_EQ(log.find("attempt 1: verified") != std::string::npos, is_debug) << log;
    if (is_debug) {
      EXPECT_NE(log.find("\"event\":\"attempt\",\"id\":\"" + answer.header("x-request-id")), std::string::npos) << log;
    }
  }
}

TEST(end_to_end, what_must_get_too_large_is_refused_at_once) {
  const DaemonProcess daemon({"--max-output-faces", "1000"});
  // 28 units squared in triangles of at most 4.4e-9: 6e9 of them.
  const test::Seconds before = daemon.processor_time();
  const Answer answer = post(daemon.port(), "/v1/remesh?max_edge_length=0.0001", kFrame);
  test::expect_within(test::Seconds(1), daemon.processor_time() - before);
  EXPECT_EQ(answer.status, 422);
  EXPECT_EQ(problem_code(answer), "output_too_large");
  const auto problem = nlohmann::json::parse(answer.body);
  EXPECT_EQ(problem["option"], "max_output_faces");
  EXPECT_EQ(problem["limit"], 1000);
  EXPECT_EQ(post(daemon.port(), "/v1/remesh", kFrame).status, 200);
}

TEST(end_to_end, plain_curl_gets_an_obj_back) {
  const DaemonProcess daemon;
  const std::string folder = ::testing::TempDir();
  const std::string in = folder + "remeshd_e2e_in.obj";
  const std::string out = folder + "remeshd_e2e_out.obj";
  std::FILE* file = std::fopen(in.c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs(kFrame.c_str(), file);
  std::fclose(file);
  EXPECT_EQ(run("curl -sSf --data-binary @" + in + " http://127.0.0.1:" + std::to_string(daemon.port()) +
                "/v1/remesh?refine=false -o " + out),
            0);
  EXPECT_EQ(run("test $(grep -c '^f ' " + out + ") = 8"), 0);
  std::remove(in.c_str());
  std::remove(out.c_str());
}

TEST(end_to_end, after_each_bad_input_the_next_request_is_served) {
  const DaemonProcess daemon({"--max-body", "10kB", "--max-faces", "20"});
  struct Case {
    std::string name, target, body;
    int status;
    std::string code;
  };
  std::string many_faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 30; ++i) many_faces += "f 1 2 3\n";
  const std::vector<Case> cases{
      {"empty body", "/v1/remesh", "", 422, "empty_mesh"},
      {"garbage", "/v1/remesh", "\x01\x02 garbage \xff\xfe", 0, ""},
      {"truncated", "/v1/remesh", kFrame.substr(0, 60), 422, ""},
      {"index 0", "/v1/remesh", kFrame + "f 0 1 2\n", 422, "index_out_of_range"},
      {"index out of range", "/v1/remesh", kFrame + "f 1 2 9\n", 422, "index_out_of_range"},
      {"negative index out of range", "/v1/remesh", kFrame + "f -1 -2 -9\n", 422, "index_out_of_range"},
      {"not a number", "/v1/remesh", "v nan 0 0\n" + kFrame, 422, "nonfinite_coordinate"},
      {"too large a number", "/v1/remesh", "v 1e999 0 0\n" + kFrame, 422, "nonfinite_coordinate"},
      {"unknown option", "/v1/remesh?refin=true", kFrame, 400, "unknown_option"},
      {"wrong type", "/v1/remesh?refine=maybe", kFrame, 400, "invalid_option"},
      {"too many faces", "/v1/remesh", many_faces, 413, "mesh_too_large"},
      {"too many bytes", "/v1/remesh", std::string(20'000, '#'), 413, "body_too_large"},
  };
  for (const Case& bad : cases) {
    const Answer answer = post(daemon.port(), bad.target, bad.body);
    if (bad.status != 0) {
      EXPECT_EQ(answer.status, bad.status) << bad.name << answer.body;
    }
    if (!bad.code.empty()) {
      EXPECT_EQ(problem_code(answer), bad.code) << bad.name;
    }
    EXPECT_TRUE(answer.status >= 400 && answer.status < 500) << bad.name << answer.status;
    EXPECT_EQ(answer.header("Content-Type"), "application/problem+json") << bad.name;
    EXPECT_EQ(post(daemon.port(), "/v1/remesh", kFrame).status, 200) << "after " << bad.name;
  }
}

TEST(end_to_end, a_running_request_ends_soon_after_its_delete) {
  const DaemonProcess daemon({"--workers", "1"});  // so that the processor's time is that of the work
  const std::string id = "end-to-end-cancel-1";
  const std::string path = "/v1/requests/" + id;
  // Work in all stages, and a million triangles of refinement alone.
  const std::pair<std::string, std::string> requests[] = {{"/v1/remesh?refine=false", bumpy_sheet(400)},
                                                          {"/v1/remesh?max_edge_length=0.01", kFrame}};
  for (const auto& [target, mesh] : requests) {
    SCOPED_TRACE(target);
    const auto cancel = [&, &target = target, &mesh = mesh] {
      RawClient client(daemon.port());
      EXPECT_TRUE(client.send(post_text(target, mesh, "X-Request-Id: " + id + "\r\n")));
      EXPECT_TRUE(eventually([&] { return get(daemon.port(), path).status == 200; }));
      EXPECT_EQ(ask(daemon.port(), "DELETE " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 204);
      const test::Seconds before = daemon.processor_time();
      EXPECT_EQ(problem_code(client.answer()), "cancelled");
      const test::Seconds took = daemon.processor_time() - before;
      EXPECT_EQ(get(daemon.port(), path).status, 404);
      return took;
    };
    test::expect_best_within(std::chrono::milliseconds(100), cancel);
  }
}

TEST(end_to_end, a_stop_lets_the_running_request_finish_and_exits_with_0) {
  DaemonProcess daemon({"--drain-time", "600s"});
  RawClient client(daemon.port());
  const std::string id = "end-to-end-drain-01";
  // Long enough to be seen while it runs.
  const int size = unless_sanitized(200, 80);
  ASSERT_TRUE(client.send(post_text("/v1/remesh?refine=false", bumpy_sheet(size), "X-Request-Id: " + id + "\r\n")));
  ASSERT_TRUE(eventually([&] { return get(daemon.port(), "/v1/requests/" + id).status == 200; }));
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(client.answer().status, 200);
  EXPECT_EQ(daemon.wait(), 0);
  EXPECT_NE(daemon.log().find("\"event\":\"stopped\""), std::string::npos);
}

TEST(end_to_end, a_busy_daemon_ends_within_its_drain_time) {
  constexpr int kDrainSeconds = 6, kWorkers = 2;
  DaemonProcess daemon({"--drain-time", std::to_string(kDrainSeconds) + "s", "--workers", std::to_string(kWorkers)});
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 3; ++i) {
    const std::string id = "end-to-end-drain-1" + std::to_string(i);
    clients.push_back(std::make_unique<RawClient>(daemon.port()));
    clients.back()->send(post_text("/v1/remesh?max_edge_length=0.002", kFrame, "X-Request-Id: " + id + "\r\n"));
    ASSERT_TRUE(eventually([&] { return get(daemon.port(), "/v1/requests/" + id).status == 200; }));
  }
  const test::Seconds before = daemon.processor_time();
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
  // The workers keep their processors busy until they are stopped, or get less than that of a busy machine.
  test::expect_within(test::Seconds(kWorkers * kDrainSeconds), daemon.processor_time() - before);
  for (const auto& client : clients) EXPECT_EQ(problem_code(client->answer()), "draining");
}

TEST(end_to_end, an_idle_daemon_stops_at_once) {
  for (const int number : {SIGTERM, SIGINT}) {
    DaemonProcess daemon({"--drain-time", "300s"});
    const auto start = std::chrono::steady_clock::now();
    daemon.send_signal(number);
    EXPECT_EQ(daemon.wait(), 0);
    // It takes some milliseconds. A daemon that waits for the drain time takes five minutes.
    test::expect_sooner_than(std::chrono::minutes(2), std::chrono::steady_clock::now() - start);
  }
}

TEST(end_to_end, health_asks_a_running_daemon) {
  const std::string binary = REMESHD_PATH;
  std::string address;
  {
    const DaemonProcess daemon;
    address = "127.0.0.1:" + std::to_string(daemon.port());
    EXPECT_EQ(run(binary + " health --bind " + address), 0);
    EXPECT_EQ(run(binary + " --bind " + address + " 2>/dev/null"), 1) << "a second daemon on the port";
  }
  EXPECT_EQ(run(binary + " health --bind " + address + " 2>/dev/null"), 1);
}

}  // namespace
}  // namespace remesh::server
