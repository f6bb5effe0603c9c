/// The real binary in a process of its own, with the real geometry.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/server/raw_client.h"

namespace remesh::server {
namespace {

/// `remeshd` on a free port; killed with the test if it still runs.
class Daemon {
 public:
  explicit Daemon(std::vector<std::string> flags = {}) {
    flags.insert(flags.begin(), {REMESHD_PATH, "--bind", "127.0.0.1:0", "--log-format", "json"});
    std::vector<char*> arguments;
    for (std::string& flag : flags) arguments.push_back(flag.data());
    arguments.push_back(nullptr);
    std::array<int, 2> pipe_ends{};
    if (::pipe(pipe_ends.data()) != 0) throw std::runtime_error("pipe");
    child_ = ::fork();
    if (child_ == 0) {
      ::dup2(pipe_ends[1], STDERR_FILENO);
      ::close(pipe_ends[0]);
      ::close(pipe_ends[1]);
      ::execv(arguments[0], arguments.data());
      ::_exit(127);
    }
    ::close(pipe_ends[1]);
    log_ = ::fdopen(pipe_ends[0], "r");
    const std::string line = read_line();
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (!event.is_object() || event.value("event", "") != "listening") throw std::runtime_error("no start: " + line);
    const std::string address = event["address"];
    port_ = std::stoi(address.substr(address.rfind(':') + 1));
  }
  ~Daemon() {
    if (child_ > 0) ::kill(child_, SIGKILL);
    if (child_ > 0) ::waitpid(child_, nullptr, 0);
    std::fclose(log_);
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  int port() const { return port_; }
  void send_signal(int number) const { ::kill(child_, number); }
  /// The exit code, or minus the signal that ended it.
  int wait() {
    int status = 0;
    ::waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  /// What is left of the log, once the daemon has ended.
  std::string rest_of_log() {
    std::string log;
    for (std::string line = read_line(); !line.empty(); line = read_line()) log += line;
    return log;
  }

 private:
  std::string read_line() {
    std::array<char, 4096> buffer{};
    return std::fgets(buffer.data(), buffer.size(), log_) == nullptr ? "" : buffer.data();
  }

  pid_t child_ = -1;
  std::FILE* log_ = nullptr;
  int port_ = 0;
};

int run(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// A square of side 8 with a square hole of side 6: area 28, of eight triangles.
const std::string kFrame =
    "v -4 -4 1\nv 4 -4 1\nv -4 4 1\nv 4 4 1\nv -3 -3 1\nv 3 -3 1\nv -3 3 1\nv 3 3 1\n"
    "f 5 3 1\nf 4 7 8\nf 1 2 6\nf 5 7 3\nf 1 6 5\nf 6 2 4\nf 4 3 7\nf 8 6 4\n";

/// A bumpy sheet of 2 n² triangles, hardly two of them in one plane: work for a while.
std::string bumpy_sheet(int n) {
  std::string text;
  unsigned state = 1;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      state = state * 1664525u + 1013904223u;
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " 0." + std::to_string(1000 + (state >> 16) % 9000) +
              "\n";
    }
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x + 1;
      const int b = a + n + 1;
      text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(b + 1) + "\n";
      text += "f " + std::to_string(a) + " " + std::to_string(b + 1) + " " + std::to_string(b) + "\n";
    }
  }
  return text;
}

std::string code_of(const Answer& answer) {
  const auto problem = nlohmann::json::parse(answer.body, nullptr, false);
  return problem.is_object() ? problem.value("code", "") : "";
}

TEST(EndToEnd, the_small_routes_answer) {
  const Daemon daemon;
  for (const char* path : {"/livez", "/readyz", "/", "/v1/capabilities", "/openapi.json"}) {
    EXPECT_EQ(get(daemon.port(), path).status, 200) << path;
  }
}

TEST(EndToEnd, a_square_with_a_hole_comes_back_as_one_patch_of_eight_triangles) {
  const Daemon daemon;
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

TEST(EndToEnd, a_plain_request_is_refined) {
  const Daemon daemon;
  const Answer answer = post(daemon.port(), "/v1/remesh", kFrame, "Accept: application/json\r\n");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const auto report = nlohmann::json::parse(answer.body)["report"];
  EXPECT_GT(report["output"]["faces"], 8u);
  EXPECT_NEAR(report["output"]["area"].get<double>(), 28, 1e-11);
  EXPECT_GE(report["output"]["quality"]["min_angle_deg"], 25.0);
  EXPECT_EQ(report["verified"]["quality"], true);
}

TEST(EndToEnd, what_must_get_too_large_is_refused_at_once) {
  const Daemon daemon({"--max-output-faces", "1000"});
  // 28 units squared in triangles of at most 4.4e-9: 6e9 of them.
  const auto start = std::chrono::steady_clock::now();
  const Answer answer = post(daemon.port(), "/v1/remesh?max_edge_length=0.0001", kFrame);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1000));
  EXPECT_EQ(answer.status, 422);
  EXPECT_EQ(code_of(answer), "output_too_large");
  const auto problem = nlohmann::json::parse(answer.body);
  EXPECT_EQ(problem["option"], "max_output_faces");
  EXPECT_EQ(problem["limit"], 1000);
  EXPECT_EQ(post(daemon.port(), "/v1/remesh", kFrame).status, 200);
}

TEST(EndToEnd, plain_curl_gets_an_obj_back) {
  const Daemon daemon;
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

TEST(EndToEnd, after_each_bad_input_the_next_request_is_served) {
  const Daemon daemon({"--max-body", "10kB", "--max-faces", "20"});
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
      EXPECT_EQ(code_of(answer), bad.code) << bad.name;
    }
    EXPECT_TRUE(answer.status >= 400 && answer.status < 500) << bad.name << answer.status;
    EXPECT_EQ(answer.header("Content-Type"), "application/problem+json") << bad.name;
    EXPECT_EQ(post(daemon.port(), "/v1/remesh", kFrame).status, 200) << "after " << bad.name;
  }
}

TEST(EndToEnd, a_running_request_ends_soon_after_its_delete) {
  const Daemon daemon;
  const std::string id = "end-to-end-cancel-1";
  const std::string path = "/v1/requests/" + id;
  // Work in all stages, and a million triangles of refinement alone.
  const std::pair<std::string, std::string> requests[] = {{"/v1/remesh?refine=false", bumpy_sheet(400)},
                                                          {"/v1/remesh?max_edge_length=0.01", kFrame}};
  for (const auto& [target, mesh] : requests) {
    SCOPED_TRACE(target);
    RawClient client(daemon.port());
    ASSERT_TRUE(client.send(post_text(target, mesh, "X-Request-Id: " + id + "\r\n")));
    ASSERT_TRUE(eventually([&] { return get(daemon.port(), path).status == 200; }));
    EXPECT_EQ(ask(daemon.port(), "DELETE " + path + " HTTP/1.1\r\nHost: x\r\n\r\n").status, 204);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(code_of(Answer::parse(client.receive())), "cancelled");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1000));
    EXPECT_EQ(get(daemon.port(), path).status, 404);
  }
}

TEST(EndToEnd, a_stop_lets_the_running_request_finish_and_exits_with_0) {
  Daemon daemon;
  RawClient client(daemon.port());
  const std::string id = "end-to-end-drain-01";
  ASSERT_TRUE(client.send(post_text("/v1/remesh?refine=false", bumpy_sheet(200), "X-Request-Id: " + id + "\r\n")));
  ASSERT_TRUE(eventually([&] { return get(daemon.port(), "/v1/requests/" + id).status == 200; }));
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(Answer::parse(client.receive()).status, 200);
  EXPECT_EQ(daemon.wait(), 0);
  EXPECT_NE(daemon.rest_of_log().find("\"event\":\"stopped\""), std::string::npos);
}

TEST(EndToEnd, an_idle_daemon_stops_at_once) {
  for (const int number : {SIGTERM, SIGINT}) {
    Daemon daemon;
    const auto start = std::chrono::steady_clock::now();
    daemon.send_signal(number);
    EXPECT_EQ(daemon.wait(), 0);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
  }
}

TEST(EndToEnd, health_asks_a_running_daemon) {
  const std::string binary = REMESHD_PATH;
  std::string address;
  {
    const Daemon daemon;
    address = "127.0.0.1:" + std::to_string(daemon.port());
    EXPECT_EQ(run(binary + " health --bind " + address), 0);
    EXPECT_EQ(run(binary + " --bind " + address + " 2>/dev/null"), 1) << "a second daemon on the port";
  }
  EXPECT_EQ(run(binary + " health --bind " + address + " 2>/dev/null"), 1);
}

}  // namespace
}  // namespace remesh::server
