// Tests the command line by running it.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "api/options.h"
#include "core/io/formats.h"
#include "tests/support/temporary_folder.h"

namespace remesh {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

/// Returns a fan of triangles.
std::string what_takes_a_while() {
  std::string big;
  for (int i = 0; i < 400000; ++i) {
    const std::string n = std::to_string(i);
    big += "v " + n + " 0 0\nv " + n + " 1 0\nv " + n + " 0 " + n + "\nf -1 -2 -3\n";
  }
  return big;
}

class cli : public testing::Test {
 protected:
  struct Outcome {
    int status;
    std::string out;
    std::string err;
  };

  void SetUp() override { write("square.obj", kSquare); }

  void write(const std::string& name, std::string_view content) const { folder_.write(name, content); }
  std::string read(const std::string& name) const { return folder_.read(name); }
  std::filesystem::path path(const std::string& name) const { return folder_.path(name); }
  std::size_t file_count() const { return folder_.entry_count(); }

  /// Starts the program in the folder; its streams go to files beside it.
  pid_t start(std::vector<std::string> arguments, std::string_view input) const {
    std::ofstream(in_path()) << input;
    arguments.insert(arguments.begin(), REMESHD_CLI_PATH);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const std::string in = in_path(), out = out_path(), err = err_path(), folder = folder_.path();
    const pid_t child = ::fork();
    if (child != 0) return child;
    const auto redirect = [](const std::string& file, int flags, int fd) {
      ::dup2(::open(file.c_str(), flags, 0600), fd);
    };
    redirect(in, O_RDONLY, STDIN_FILENO);
    redirect(out, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
    redirect(err, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
    if (::chdir(folder.c_str()) == 0) ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  Outcome finish(pid_t child) const {
    int status = 0;
    ::waitpid(child, &status, 0);
    const auto slurp = [](const std::string& file) {
      std::ifstream stream(file);
      return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(out_path()), slurp(err_path())};
    for (const std::string& file : {in_path(), out_path(), err_path()}) std::filesystem::remove(file);
    return outcome;
  }

  /// Before that an interrupt would end the program by force.
  static void wait_until_it_handles_interrupts(pid_t child) {
    for (int tries = 0; tries < 120'000; ++tries) {  // minutes: it may be a busy machine
      std::ifstream status("/proc/" + std::to_string(child) + "/status");
      for (std::string line; std::getline(status, line);) {
        if (!line.starts_with("SigCgt:")) continue;
        const std::uint64_t caught = std::stoull(line.substr(7), nullptr, 16);
        if ((caught >> (SIGINT - 1) & 1) != 0) return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    FAIL() << "the program never got ready";
  }

  Outcome run(std::vector<std::string> arguments, std::string_view input = "") const {
    return finish(start(std::move(arguments), input));
  }

 private:
  // Beside the folder, so that it holds only what the program made.
  std::string in_path() const { return folder_.path() + ".in"; }
  std::string out_path() const { return folder_.path() + ".out"; }
  std::string err_path() const { return folder_.path() + ".err"; }

  const test::TemporaryFolder folder_;
};

TEST_F(cli, two_meshes_are_compared_and_the_exit_code_says_whether_they_are_within_the_tolerance) {
  write("raised.obj", "v 0 0 0.5\nv 1 0 0.5\nv 1 1 0.5\nv 0 1 0.5\nf 1 2 3 4\n");
  const Outcome both = run({"--compare", "square.obj", "raised.obj"});
  EXPECT_EQ(both.status, 0) << both.err;
  const nlohmann::json answer = nlohmann::json::parse(both.out);
  EXPECT_NEAR(answer["a_to_b"]["bound"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(answer["within"], nullptr);
  EXPECT_EQ(run({"--compare", "square.obj", "raised.obj", "--tolerance", "0.6"}).status, 0);
  const Outcome no = run({"--compare", "square.obj", "raised.obj", "--tolerance", "0.4"});
  EXPECT_EQ(no.status, 3);
  EXPECT_EQ(nlohmann::json::parse(no.out)["within"], false);
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(cli, a_comparison_names_the_file_that_is_wrong_and_takes_no_other_options) {
  write("bad.obj", "v 0 0 0\nf 1 2 3\n");
  const Outcome bad = run({"--compare", "square.obj", "bad.obj"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.err, HasSubstr("bad.obj:2: index_out_of_range"));
  EXPECT_EQ(run({"--compare", "square.obj"}).status, 2);
  EXPECT_EQ(run({"--compare", "square.obj", "square.obj", "--tolerance", "x"}).status, 2);
  EXPECT_EQ(run({"--compare", "square.obj", "square.obj", "--min-angle-deg", "20"}).status, 2);
  EXPECT_EQ(run({"--compare", "square.obj", "square.obj", "-o", "out.obj"}).status, 2);
  EXPECT_EQ(run({"square.obj", "-o", "out.obj", "--tolerance", "1"}).status, 2);
}

TEST_F(cli, a_mesh_goes_in_and_comes_out_with_its_report) {
  const Outcome outcome = run({"square.obj", "-o", "out.obj", "--report", "report.json", "--workers", "1"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(read("out.obj"), StartsWith("# remeshd "));
  const nlohmann::json report = nlohmann::json::parse(read("report.json"));
  EXPECT_THAT(outcome.err, StartsWith("remesh: 2 faces in, " + report["output"]["faces"].dump() +
                                      " out; the least angle is 45 degrees; input and result are at most "));
  EXPECT_EQ(report["input"]["faces"], 2);
  EXPECT_EQ(report["verified"]["surface"], true);
  EXPECT_EQ(report["options"]["format"], "obj");
  EXPECT_EQ(file_count(), 3u);
}

TEST_F(cli, a_hyphen_is_standard_input_and_output) {
  const Outcome outcome = run({"-", "-o", "-"}, kSquare);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nf "));
  ASSERT_EQ(run({"square.obj", "-o", "out.obj"}).status, 0);
  EXPECT_EQ(outcome.out, read("out.obj"));
}

TEST_F(cli, the_format_is_the_endings_unless_it_is_given) {
  EXPECT_EQ(run({"square.obj", "-o", "out.json"}).status, 0);
  EXPECT_TRUE(nlohmann::json::parse(read("out.json")).contains("mesh"));
  EXPECT_EQ(run({"out.json", "-o", "back.obj"}).status, 0);
  EXPECT_THAT(read("back.obj"), HasSubstr("\nv 0 0 0\n"));
  EXPECT_EQ(run({"square.obj", "-o", "out.dat", "--format", "json"}).status, 0);
  EXPECT_TRUE(nlohmann::json::accept(read("out.dat")));
  EXPECT_EQ(run({"square.obj", "-o", "as_input"}).status, 0);
  EXPECT_THAT(read("as_input"), StartsWith("# remeshd "));
  EXPECT_EQ(run({"square.obj", "-o", "out.vtu"}).status, 0);
  EXPECT_THAT(read("out.vtu"), HasSubstr("<VTKFile"));
}

TEST_F(cli, a_file_that_ends_in_gz_is_compressed_in_and_out) {
  EXPECT_EQ(run({"square.obj", "-o", "plain.obj"}).status, 0);
  EXPECT_EQ(run({"square.obj", "-o", "packed.obj.gz"}).status, 0);
  EXPECT_THAT(read("packed.obj.gz"), StartsWith("\x1f\x8b"));
  EXPECT_EQ(run({"packed.obj.gz", "-o", "again.ply"}).status, 0);
  EXPECT_EQ(run({"again.ply", "-o", "again.obj"}).status, 0);
  EXPECT_EQ(read("again.obj"), read("plain.obj"));
  EXPECT_EQ(run({"square.obj", "-o", "out.xyz.gz"}).status, 2);
}

TEST_F(cli, an_error_in_binary_data_names_the_byte) {
  EXPECT_EQ(run({"square.obj", "-o", "whole.stl"}).status, 0);
  write("cut.stl", read("whole.stl").substr(0, 100));
  const Outcome cut = run({"cut.stl", "-o", "out.obj"});
  EXPECT_EQ(cut.status, 1);
  EXPECT_THAT(cut.err, StartsWith("remesh: cut.stl: byte 100: invalid_mesh: "));
}

/// Returns the fields of a table without quotes. The rows begin with the names of their files.
std::map<std::string, std::vector<std::string>> rows_of(const std::string& table) {
  std::map<std::string, std::vector<std::string>> rows;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line + ",");
    std::vector<std::string> row;
    for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
    rows[row.front()] = row;
  }
  return rows;
}

TEST_F(cli, a_batch_is_a_table_with_a_line_for_each_mesh_and_stops_at_none) {
  write("parts/a.obj", kSquare);
  write("parts/bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  write("parts/deep/b.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  write("parts/readme.txt", "no mesh");
  const Outcome outcome = run({"--batch", "parts", "--report", "out.csv", "--refine", "false", "--workers", "2"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.err, "remesh: 1 of 3 files failed; out.csv says why\n");
  auto rows = rows_of(read("out.csv"));
  ASSERT_EQ(rows.size(), 4u);
  const std::vector<std::string> columns = rows.at("file");
  const auto cell = [&](const std::string& file, const std::string& column) {
    const auto at = std::find(columns.begin(), columns.end(), column) - columns.begin();
    return rows.at(file).at(static_cast<std::size_t>(at));
  };
  EXPECT_EQ(cell("a.obj", "status"), "ok");
  EXPECT_EQ(cell("a.obj", "faces_in"), "2");
  EXPECT_EQ(cell("a.obj", "verified"), "true");
  EXPECT_EQ(cell("deep/b.off", "faces_out"), "1");
  EXPECT_EQ(cell("bad.obj", "status"), "failed");
  EXPECT_EQ(cell("bad.obj", "code"), "index_out_of_range");
  EXPECT_THAT(cell("bad.obj", "message"), HasSubstr("bad.obj:4: "));
}

TEST_F(cli, a_batch_writes_its_meshes_where_it_is_told_none_over_another) {
  write("parts/a.obj", kSquare);
  write("parts/a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  write("parts/deep/c.obj", kSquare);
  const Outcome batch = run({"--batch", "parts", "--report", "-", "-o", "done", "--format", "obj"});
  EXPECT_EQ(batch.status, 0);
  EXPECT_EQ(batch.err, "remesh: 3 files are remeshed; standard output has a line for each\n");
  EXPECT_THAT(read("done/a.obj"), HasSubstr("input_faces=2"));
  EXPECT_THAT(read("done/a.off.obj"), HasSubstr("input_faces=1"));
  EXPECT_THAT(read("done/deep/c.obj"), StartsWith("# remeshd "));
}

TEST_F(cli, a_batch_onto_itself_is_misuse_and_one_without_a_mesh_says_so) {
  const Outcome onto_itself = run({"--batch", ".", "--report", "-", "-o", "./"});
  EXPECT_EQ(onto_itself.status, 2);
  EXPECT_THAT(onto_itself.err, HasSubstr("the folder that --batch reads"));
  EXPECT_EQ(read("square.obj"), kSquare);
  write("empty/readme.txt", "no mesh");
  const Outcome empty = run({"--batch", "empty", "--report", "-"});
  EXPECT_EQ(empty.status, 0);
  EXPECT_EQ(empty.err, "remesh: no mesh found below empty\n");
}

/// A box without a lid.
constexpr std::string_view kOpenBox =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST_F(cli, a_success_is_told_with_what_it_missed_and_the_option_that_helps_unless_it_is_to_be_quiet) {
  write("box.obj", kOpenBox);
  const Outcome outcome = run({"box.obj", "-o", "out.obj"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, StartsWith("remesh: 5 faces in, 10 out; the least angle is 45 degrees"));
  EXPECT_THAT(outcome.err, HasSubstr("\nremesh: a volume mesher will refuse the result, because of 4 open_boundary\n"));
  EXPECT_THAT(outcome.err, HasSubstr("\nremesh: --repair +holes would close small holes\n"));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 3);
  // The flags do what is said of them, and then there is nothing more to say.
  const Outcome closed = run({"box.obj", "-o", "closed.obj", "--repair", "+holes", "--report", "report.json"});
  EXPECT_EQ(std::count(closed.err.begin(), closed.err.end(), '\n'), 1) << closed.err;
  EXPECT_EQ(nlohmann::json::parse(read("report.json"))["volume_ready"]["ready"], true);
  const Outcome quiet = run({"box.obj", "-o", "quiet.obj", "--quiet"});
  EXPECT_EQ(quiet.err, "");
  EXPECT_EQ(read("quiet.obj"), read("out.obj"));
}

TEST_F(cli, an_ending_that_cannot_be_written_names_all_that_can) {
  const std::string told = run({"square.obj", "-o", "o.step"}).err;
  for (const Format format : kFormats) {
    const auto has_ending = HasSubstr("." + std::string(file_ending(format)) + ",");
    EXPECT_EQ(testing::Value(told, has_ending), is_written(format)) << format_name(format) << ": " << told;
  }
  // These are read, but what is written has another ending.
  for (const char* output : {"o.vtp", "o.vtk.gz", "o.gltf", "o.3mf"})
    EXPECT_EQ(run({"square.obj", "-o", output}).status, 2) << output;
}

TEST_F(cli, a_folder_may_have_files_of_every_ending_that_is_read) {
  write("parts/a.vtk",
        "# vtk DataFile Version 3.0\nsquare\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0\n1 0 0\n"
        "1 1 0\n0 1 0\nPOLYGONS 1 5\n4 0 1 2 3\n");
  write("parts/b.mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n3\n0 0 0 0\n1 0 0 0\n0 1 0 0\nTriangles\n1\n"
        "1 2 3 7\nEnd\n");
  write("parts/c.txt", "no mesh");
  const Outcome outcome = run({"--batch", "parts", "--report", "parts.csv", "-o", "out", "--quiet"});
  EXPECT_EQ(outcome.status, 0) << read("parts.csv");
  EXPECT_THAT(read("out/a.vtu"), HasSubstr("<VTKFile"));
  EXPECT_THAT(read("out/b.mesh"), HasSubstr("Triangles"));
  EXPECT_EQ(run({"parts/a.vtk", "-o", "a.obj"}).status, 0);
}

TEST_F(cli, a_file_of_a_cad_program_is_told_what_it_is_and_the_command_that_makes_a_mesh_of_it) {
  write("part.step", "ISO-10303-21;\nHEADER;\n");
  const Outcome outcome = run({"part.step", "-o", "out.obj"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("STEP"));
  EXPECT_THAT(outcome.err, HasSubstr("gmsh part.step -2 -clcurv 40 -o part.stl"));
}

TEST_F(cli, options_have_hyphens) {
  const Outcome outcome = run({"square.obj", "-o", "out.obj", "--keep-boundary-vertices", "true",
                               "--plane-tolerance=1e-5", "--reference-axis", "-1,0,0", "--report", "-"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json options = nlohmann::json::parse(outcome.out)["options"];
  EXPECT_EQ(options["keep_boundary_vertices"], true);
  EXPECT_EQ(options["plane_tolerance"], 1e-5);
  EXPECT_EQ(options["reference_axis"], "-1,0,0");
}

TEST_F(cli, a_trace_goes_to_standard_error_and_changes_nothing) {
  const Outcome plain = run({"square.obj", "-o", "-", "--quiet"});
  const Outcome traced = run({"square.obj", "-o", "-", "--quiet", "--trace"});
  ASSERT_EQ(traced.status, 0) << traced.err;
  EXPECT_EQ(traced.out, plain.out);
  EXPECT_EQ(plain.err, "");
  EXPECT_THAT(traced.err, StartsWith("remesh: attempt 1: verified, "));
}

TEST_F(cli, misuse_is_told_in_one_line_and_exits_with_2) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{}, "input is required"},
      {{"square.obj"}, "output is required"},
      {{"square.obj", "-o", "o.obj", "--min-angel-deg", "20"}, "the nearest is --min-angle-deg"},
      {{"square.obj", "-o", "o.obj", "--plane-tolerance", "wide"}, "invalid_option: plane_tolerance must be"},
      {{"square.obj", "-o", "o.obj", "--plane-tolerance", "1", "--plane-tolerance", "2"}, "--plane-tolerance"},
      {{"square.obj", "-o", "o.obj", "--refine"}, "--refine"},
      {{"square.obj", "-o", "o.obj", "--weld-tolerance", "-1"}, "invalid_option: weld_tolerance must be"},
      {{"square.obj", "-o", "o.obj", "--max-edge-length", "1", "--max-edge-fraction", "1"}, "exclude each other"},
      {{"square.obj", "-o", "o.obj", "--workers", "0"}, "--workers"},
      {{"square.obj", "other.obj", "-o", "o.obj"}, "unexpected argument other.obj"},
      {{"square.obj", "-o", "-", "--report", "-"}, "standard output"},
      {{"square.obj", "-o", "o.json", "--report", "o.json"}, "cannot both go to o.json"},
      {{"square.obj", "--batch", ".", "--report", "o.csv"}, "--batch cannot be combined with the input square.obj"},
      {{"--batch", "."}, "--batch needs --report"},
      {{"square.obj", "--analyze", "-o", "o.obj"}, "--analyze cannot be combined with --output"},
      {{"square.obj", "--analyze", "--server", "http://host"}, "--analyze cannot be combined with --server"},
      {{"--batch", ".", "--report", "o.csv", "--analyze"}, "--analyze cannot be combined with --batch"},
      {{"square.obj", "--analyze", "--report", "-"}, "with --analyze the report cannot go to standard output"},
      {{"square.obj", "--analyze", "--format", "obj"}, "an analysis is written as json only"},
      {{"square.obj", "-o", "o.obj", "--server", "ftp://host"}, "ftp://host is not an http or https URL"},
      {{"square.obj", "-o", "o.obj", "--server", "http://host", "--workers", "1"}, "--workers cannot be combined"},
      {{"square.obj", "--analyze", "--trace"}, "--trace cannot be combined with"},
      {{"square.obj", "-o", "o.obj", "--server", "http://host", "--trace"}, "--trace cannot be combined with"},
      {{"square.obj", "-o", "o.step"}, "the ending of o.step does not name a format that can be written; these do: "}};
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_THAT(outcome.err, StartsWith("remesh: "));
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(file_count(), 1u);
  }
}

TEST_F(cli, failure_is_told_with_file_and_line_and_exits_with_1) {
  write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  const Outcome bad = run({"bad.obj", "-o", "out.obj"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.err, StartsWith("remesh: bad.obj:4: index_out_of_range: "));
  EXPECT_EQ(run({"missing.obj", "-o", "out.obj"}).err, "remesh: missing.obj: No such file or directory\n");
  EXPECT_EQ(run({"square.obj", "-o", "no/such/folder.obj"}).status, 1);
  EXPECT_EQ(run({"-", "-o", "out.obj"}, "").status, 1);
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(cli, a_result_beyond_its_bound_is_the_meshs_failure_not_misuse) {
  const Outcome outcome = run({"square.obj", "-o", "out.obj", "--refine", "false", "--max-output-faces", "1"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("output_too_large: "));
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(cli, refinement_is_on_unless_it_is_turned_off) {
  // A strip of 1 by 10: two triangles have 6 degrees.
  write("strip.obj", "v 0 0 0\nv 10 0 0\nv 10 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const auto faces = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"strip.obj", "-o", "out.obj", "--report", "report.json"});
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(read("report.json"))["output"]["faces"].get<int>();
  };
  EXPECT_EQ(faces({"--refine", "false"}), 2);
  const int refined = faces({});
  EXPECT_GT(refined, 2);
  EXPECT_GT(faces({"--max-edge-length", "0.3", "--min-angle-deg", "30"}), refined);
}

TEST_F(cli, a_failure_leaves_an_older_output_as_it_was) {
  write("bad.obj", "f 1 2 3\n");
  write("out.obj", "old");
  EXPECT_EQ(run({"bad.obj", "-o", "out.obj"}).status, 1);
  EXPECT_EQ(read("out.obj"), "old");
}

TEST_F(cli, a_link_and_its_permissions_stay) {
  write("real.obj", "old");
  std::filesystem::permissions(path("real.obj"), std::filesystem::perms(0640));
  std::filesystem::create_symlink("real.obj", path("link.obj"));
  ASSERT_EQ(run({"square.obj", "-o", "link.obj"}).status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.obj")));
  EXPECT_THAT(read("real.obj"), StartsWith("# remeshd "));
  EXPECT_EQ(std::filesystem::status(path("real.obj")).permissions(), std::filesystem::perms(0640));
}

TEST_F(cli, what_is_no_ordinary_file_is_written_as_it_is) {
  EXPECT_EQ(run({"square.obj", "-o", "/dev/null"}).status, 0);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(cli, an_analysis_prints_what_the_mesh_consists_of) {
  const Outcome outcome = run({"square.obj", "--analyze", "--report", "report.json", "--max-edge-length", "0.1"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, StartsWith("square.obj: 2 faces, open, 1 x 1 x 0\n"
                                      "     area    faces  surfaces\n"
                                      "  100.0 %        2  1 plane\n"
                                      "warning: open_boundary: 4: "));
  const nlohmann::json report = nlohmann::json::parse(read("report.json"));
  EXPECT_EQ(report["surfaces"].size(), 1u);
  EXPECT_FALSE(report.contains("output"));
  EXPECT_THAT(outcome.out, HasSubstr("makes about " + report["predicted_faces"].dump() + " faces\n"));
  EXPECT_EQ(file_count(), 2u);
  EXPECT_THAT(run({"-", "--analyze"}, kSquare).out, StartsWith("standard input: 2 faces"));
}

TEST_F(cli, help_lists_every_option_with_its_default) {
  const Outcome help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("--max-radius-edge-ratio"));
  EXPECT_THAT(help.out, HasSubstr("[dominant_edge]"));
  EXPECT_THAT(help.out, HasSubstr("[25]"));
  // The options stand in their groups, and the groups in their order.
  std::size_t at = 0;
  std::string_view heading;
  for (const api::OptionSpec& spec : api::option_table()) {
    const std::string_view group = api::group_name(spec.group);
    if (group != heading) {
      std::string title = "\n" + std::string(group) + ":\n";
      title[1] = static_cast<char>(std::toupper(title[1]));
      at = help.out.find(title, at);
      ASSERT_NE(at, std::string::npos) << title;
      heading = group;
    }
    std::string flag = "  --" + std::string(spec.name) + " ";
    std::replace(flag.begin(), flag.end(), '_', '-');
    at = help.out.find(flag, at);
    ASSERT_NE(at, std::string::npos) << spec.name;
  }
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, StartsWith("remesh "));
}

TEST_F(cli, an_interrupt_ends_the_run_and_leaves_no_file) {
  write("big.obj", what_takes_a_while());
  const pid_t child = start({"big.obj", "-o", "out.obj"}, "");
  wait_until_it_handles_interrupts(child);
  ASSERT_EQ(::kill(child, SIGINT), 0);
  const Outcome outcome = finish(child);
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("cancelled"));
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(cli, a_batch_that_is_killed_leaves_the_lines_of_what_was_done) {
  write("parts/big.obj", what_takes_a_while());
  write("parts/small.obj", kSquare);
  const pid_t child = start({"--batch", "parts", "--report", "out.csv", "--workers", "2"}, "");
  for (int tries = 0; tries < 120'000 && read("out.csv").find("small.obj,ok,") == std::string::npos; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child, SIGKILL);
  EXPECT_EQ(finish(child).status, -1) << "it had ended before";
  EXPECT_THAT(read("out.csv"), StartsWith("file,status,"));
  EXPECT_THAT(read("out.csv"), HasSubstr("\nsmall.obj,ok,"));
}

TEST_F(cli, a_place_that_cannot_be_written_to_is_told_before_the_work) {
  for (const std::vector<std::string>& places : {std::vector<std::string>{"-o", "none/out.obj"},
                                                 {"-o", "out.obj", "--report", "none/report.json"},
                                                 {"-o", "none/out.obj", "--server", "http://127.0.0.1:1"}}) {
    std::vector<std::string> arguments{"no_such_mesh.obj"};
    arguments.insert(arguments.end(), places.begin(), places.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, StartsWith("remesh: none/"));
  }
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(cli, an_interrupt_ends_the_wait_for_input) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const int writer = ::open(path("pipe").c_str(), O_RDWR);  // keeps the pipe open, and empty
  const pid_t child = start({"pipe", "-o", "out.obj"}, "");
  wait_until_it_handles_interrupts(child);
  // It may still be on its way to the read: interrupted there or before, it ends.
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    ::kill(child, SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ::close(writer);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(cli, a_copy_of_the_program_without_the_http_library_remeshes_but_asks_no_server) {
  std::filesystem::copy_file(REMESHD_CLI_PATH, path("alone"));
  const auto run = [&](const std::string& more) {
    const std::string folder = path("alone").parent_path();
    return std::system(("cd '" + folder + "' && ./alone square.obj -o out.obj " + more + " 2>err").c_str());
  };
  EXPECT_EQ(run(""), 0);
  EXPECT_NE(run("--server http://127.0.0.1:1"), 0);
  EXPECT_THAT(read("err"), HasSubstr("remesh_http.so"));
}

}  // namespace
}  // namespace remesh
