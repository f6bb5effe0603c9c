#include "api/cli/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "api/cli/files.h"
#include "core/io/gzip.h"
#include "tests/support/errors.h"
#include "tests/support/temporary_folder.h"

namespace remesh::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// Its open boundary is one warning.
constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
constexpr const char* kColumns =
    "file,status,code,faces_in,faces_out,patches,kept,min_angle_deg,max_angle_deg,verified,warnings,seconds,message";

/// Returns a line of the table with S in place of the seconds, which are the one number with three decimals.
std::string without_seconds(std::string line) {
  constexpr const char* kDigits = "0123456789";
  for (std::size_t dot = line.find('.'); dot != std::string::npos; dot = line.find('.', dot + 1)) {
    const std::size_t before = line.find_last_not_of(kDigits, dot - 1), end = line.find_first_not_of(kDigits, dot + 1);
    if (before == std::string::npos || line[before] != ',' || before + 1 == dot || end != dot + 4 || line[end] != ',')
      continue;
    return line.replace(before + 1, end - before - 1, "S");
  }
  return line;
}

class batch : public testing::Test {
 protected:
  batch() { folder_.write("parts/.keep", ""); }

  BatchJob job(int workers = 1) const {
    BatchJob job;
    job.folder = folder_.path("parts");
    job.report = folder_.path("table.csv");
    job.options = {{"refine", "false"}};
    job.limits.workers = workers;
    return job;
  }
  BatchOutcome run(const BatchJob& job) { return run_batch(job, control_); }
  std::vector<std::string> table() const {
    std::istringstream text(folder_.read("table.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(without_seconds(line));
    return lines;
  }

  const test::TemporaryFolder folder_;
  RunControl control_;
};

TEST_F(batch, a_row_is_what_became_of_a_mesh_by_its_name) {
  folder_.write("parts/z.obj", kSquare);
  folder_.write("parts/a/b.obj", "v 0 0 0\nf 1 1 2\n");
  const BatchOutcome outcome = run(job());
  EXPECT_EQ(outcome.files, 2u);
  EXPECT_EQ(outcome.failed, 1u);
  const std::vector<std::string> rows = table();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0], kColumns);
  EXPECT_THAT(rows[1], StartsWith("a/b.obj,failed,index_out_of_range,,,,,,,,,S,"));
  EXPECT_THAT(rows[1], HasSubstr("a/b.obj:2: index_out_of_range: "));
  EXPECT_EQ(rows[2], "z.obj,ok,,2,2,1,0,45,90,true,1,S,");
}

TEST_F(batch, a_name_with_a_comma_or_a_quote_stays_one_field_and_a_line_end_becomes_a_blank) {
  folder_.write("parts/a,b.obj", kSquare);
  folder_.write("parts/c\"d.obj", kSquare);
  folder_.write("parts/e\nf.obj", kSquare);
  run(job());
  const std::vector<std::string> rows = table();
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_THAT(rows[1], StartsWith("\"a,b.obj\",ok,"));
  EXPECT_THAT(rows[2], StartsWith("\"c\"\"d.obj\",ok,"));
  EXPECT_THAT(rows[3], StartsWith("e f.obj,ok,"));
}

TEST_F(batch, the_table_is_the_same_for_any_number_of_workers) {
  for (const char* name : {"a.obj", "b.obj", "c.obj", "d.obj", "e.obj"})
    folder_.write(std::string("parts/") + name, kSquare);
  folder_.write("parts/bad.obj", "f 1 2 3\n");
  run(job(1));
  const std::vector<std::string> alone = table();
  ASSERT_EQ(alone.size(), 7u);
  for (const int workers : {2, 3, 16}) {
    run(job(workers));
    EXPECT_EQ(table(), alone) << workers;
  }
}

TEST_F(batch, what_is_no_mesh_by_its_ending_is_passed_over_and_a_compressed_mesh_is_not) {
  RunControl control;
  folder_.write("parts/part.obj.gz", gzip(kSquare, control));
  folder_.write("parts/readme.txt", "no mesh");
  folder_.write("parts/only_written.smesh", "no mesh that is read");
  BatchJob with_output = job();
  with_output.output_folder = folder_.path("done");
  EXPECT_EQ(run(with_output).files, 1u);
  EXPECT_THAT(table(), ElementsAre(kColumns, "part.obj.gz,ok,,2,2,1,0,45,90,true,1,S,"));
  EXPECT_THAT(folder_.read("done/part.obj"), HasSubstr("input_faces=2"));
}

TEST_F(batch, an_empty_folder_is_a_table_without_rows_and_a_missing_one_an_error) {
  const BatchOutcome outcome = run(job());
  EXPECT_EQ(outcome.files, 0u);
  EXPECT_EQ(outcome.failed, 0u);
  EXPECT_THAT(table(), ElementsAre(kColumns));
  BatchJob missing = job();
  missing.folder = folder_.path("none");
  EXPECT_THROW(run(missing), FileError);
}

TEST_F(batch, no_mesh_is_written_over_whatever_the_output_folder_is_called) {
  folder_.write("parts/a.obj", kSquare);
  folder_.write("parts/parts/a.obj", kSquare);
  std::filesystem::create_directory_symlink(folder_.path("parts"), folder_.path("link"));
  // The last one has parts/parts/a.obj written to parts/a.obj.
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"parts", "parts"}, {"parts", "link"}, {"parts", "parts/../parts/"}, {"parts", ""}}) {
    BatchJob onto_itself = job();
    onto_itself.folder = folder_.path(from);
    onto_itself.output_folder = folder_.path(to);
    EXPECT_EQ(test::error_of([&] { run(onto_itself); }).option, "output") << to;
    EXPECT_EQ(folder_.read("parts/a.obj"), kSquare);
    EXPECT_EQ(folder_.read("parts/parts/a.obj"), kSquare);
  }
}

TEST_F(batch, an_output_folder_inside_the_folder_is_not_read) {
  folder_.write("parts/a.obj", kSquare);
  BatchJob inside = job();
  inside.output_folder = folder_.path("parts/done");
  for (int time = 0; time < 3; ++time) EXPECT_EQ(run(inside).files, 1u);
  EXPECT_EQ(folder_.read("parts/done/done/a.obj"), "");
}

TEST_F(batch, an_output_that_cannot_be_written_fails_its_file_and_no_other) {
  folder_.write("parts/a.obj", kSquare);
  folder_.write("parts/b.obj", kSquare);
  folder_.write("done/a.obj/in_the_way", "");
  BatchJob with_output = job();
  with_output.output_folder = folder_.path("done");
  EXPECT_EQ(run(with_output).failed, 1u);
  EXPECT_THAT(table(), ElementsAre(kColumns, HasSubstr("a.obj,failed,file_error,"), StartsWith("b.obj,ok,")));
}

TEST_F(batch, where_nothing_can_be_written_nothing_is_remeshed) {
  folder_.write("parts/a.obj", kSquare);
  folder_.write("file", "");
  BatchJob no_table = job();
  no_table.output_folder = folder_.path("done");
  no_table.report = folder_.path("none/table.csv");
  EXPECT_THROW(run(no_table), FileError);
  EXPECT_FALSE(std::filesystem::exists(folder_.path("done")));
  BatchJob no_folder = job();
  no_folder.output_folder = folder_.path("file");
  EXPECT_THROW(run(no_folder), FileError);
}

TEST_F(batch, a_stop_ends_every_file_and_the_table_says_so) {
  folder_.write("parts/a.obj", kSquare);
  folder_.write("parts/b.obj", kSquare);
  control_.cancel();
  EXPECT_EQ(run(job()).failed, 2u);
  EXPECT_THAT(table(),
              ElementsAre(kColumns, StartsWith("a.obj,failed,cancelled,"), StartsWith("b.obj,failed,cancelled,")));
}

}  // namespace
}  // namespace remesh::cli
