#include "api/cli/files.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "tests/support/temporary_folder.h"

namespace remesh::cli {
namespace {

using testing::HasSubstr;

class files : public testing::Test {
 protected:
  std::string read_by_us(const std::string& name) const {
    return std::string(read_file(folder_.path(name), control_).view());
  }
  /// Returns the text of the FileError that `act` throws, or an empty text if it throws none.
  template <typename Act>
  static std::string complaint(const Act& act) {
    try {
      act();
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }

  const test::TemporaryFolder folder_;
  RunControl control_;
};

/// Returns bytes of every value. There are more of them than are read at once.
std::string many_bytes() {
  std::string bytes(3'000'001, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i % 251);
  return bytes;
}

TEST_F(files, a_file_is_read_to_its_last_byte) {
  for (const std::string& content : {std::string(), std::string("a\0b\r\n", 5), many_bytes()}) {
    folder_.write("part", content);
    EXPECT_TRUE(read_by_us("part") == content) << content.size() << " bytes";
  }
}

TEST_F(files, an_open_file_is_read_from_where_it_stands_and_left_at_its_end) {
  const std::string content = many_bytes();
  folder_.write("part", content);
  const int fd = ::open(folder_.path("part").c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  ASSERT_EQ(::lseek(fd, 7, SEEK_SET), 7);
  const FileContent rest = FileContent::read(fd, "part", control_), nothing = FileContent::read(fd, "part", control_);
  ::close(fd);
  EXPECT_TRUE(rest.view() == std::string_view(content).substr(7)) << rest.view().size() << " bytes";
  EXPECT_EQ(nothing.view(), "");
}

TEST_F(files, a_pipe_is_read_until_it_is_closed_however_it_comes) {
  ASSERT_EQ(::mkfifo(folder_.path("pipe").c_str(), 0600), 0);
  const std::string content = many_bytes();
  std::thread writer([&] {
    std::ofstream pipe(folder_.path("pipe"), std::ios::binary);
    pipe << content.substr(0, 10) << std::flush << content.substr(10);
  });
  const std::string got = read_by_us("pipe");
  writer.join();
  EXPECT_TRUE(got == content) << got.size() << " bytes";
}

TEST_F(files, what_cannot_be_read_is_named_with_the_reason) {
  EXPECT_EQ(complaint([&] { read_by_us("none"); }), folder_.path("none") + ": No such file or directory");
  EXPECT_EQ(complaint([&] { read_file(folder_.path(), control_); }), folder_.path() + ": Is a directory");
}

TEST_F(files, a_stop_ends_reading) {
  folder_.write("part", "v 0 0 0\n");
  control_.cancel();
  try {
    read_by_us("part");
    FAIL() << "it was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kCancelled);
  }
}

TEST_F(files, a_new_file_has_its_content_and_the_permissions_of_any_other) {
  const mode_t mask = ::umask(027);
  write_file(folder_.path("out"), many_bytes());
  ::umask(mask);
  EXPECT_TRUE(folder_.read("out") == many_bytes());
  struct stat status {};
  ASSERT_EQ(::stat(folder_.path("out").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640u);
  EXPECT_EQ(folder_.entry_count(), 1u);
}

TEST_F(files, pieces_are_one_file) {
  write_file(folder_.path("out"), std::vector<std::string>{"a", "", "bc\n", "d"});
  EXPECT_EQ(folder_.read("out"), "abc\nd");
}

TEST_F(files, whoever_reads_the_old_file_reads_it_to_its_end) {
  folder_.write("out", "the old content");
  std::ifstream reader(folder_.path("out"));
  std::string first;
  reader >> first;
  write_file(folder_.path("out"), "new");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), " old content");
  EXPECT_EQ(folder_.read("out"), "new");
}

TEST_F(files, a_link_into_another_folder_leads_to_the_new_content) {
  folder_.write("kept/real", "old");
  std::filesystem::create_symlink("kept/real", folder_.path("link"));
  write_file(folder_.path("link"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder_.path("link")));
  EXPECT_EQ(folder_.read("kept/real"), "new");
}

TEST_F(files, a_write_that_fails_says_why_and_leaves_nothing) {
  std::filesystem::create_directory(folder_.path("folder"));
  EXPECT_EQ(complaint([&] { write_file(folder_.path("folder"), "x"); }), folder_.path("folder") + ": Is a directory");
  EXPECT_EQ(complaint([&] { write_file(folder_.path("no/file"), "x"); }),
            folder_.path("no/file") + ": No such file or directory");
  EXPECT_EQ(complaint([] { write_file("/dev/full", "x"); }), "/dev/full: No space left on device");
  // A name as long as can be: the file beside it has no name then.
  EXPECT_THAT(complaint([&] { write_file(folder_.path(std::string(255, 'a')), "x"); }),
              HasSubstr("File name too long"));
  EXPECT_EQ(folder_.entry_count(), 1u);
}

TEST_F(files, whether_a_file_could_be_written_is_told_without_writing_it) {
  folder_.write("old", "old");
  folder_.write("folder/file", "");
  const auto check = [&](const std::string& path) { return complaint([&] { check_writable(path); }); };
  for (const std::string& path : {folder_.path("new"), folder_.path("old"), std::string("-"), std::string("/dev/null"),
                                  std::string("in_the_working_folder")}) {
    EXPECT_EQ(check(path), "");
  }
  EXPECT_EQ(check(folder_.path("none/new")), folder_.path("none/new") + ": No such file or directory");
  EXPECT_EQ(check(folder_.path("old/new")), folder_.path("old/new") + ": Not a directory");
  EXPECT_EQ(check(folder_.path("folder")), folder_.path("folder") + ": Is a directory");
  EXPECT_EQ(folder_.entry_count(), 2u);
  EXPECT_EQ(folder_.read("old"), "old");
}

TEST_F(files, a_draft_has_what_was_appended_at_once_and_takes_the_place_of_what_was_there) {
  folder_.write("table", "an older and longer one");
  Draft draft(folder_.path("table"));
  draft.append("one,");
  EXPECT_EQ(folder_.read("table"), "one,");
  draft.append("two");
  EXPECT_EQ(folder_.read("table"), "one,two");
}

TEST_F(files, a_draft_leaves_alone_what_is_no_ordinary_file) {
  ASSERT_EQ(::mkfifo(folder_.path("pipe").c_str(), 0600), 0);
  for (const std::string& path : {folder_.path("pipe"), std::string("-"), folder_.path("none/table")})
    Draft(path).append("nothing");
  EXPECT_EQ(folder_.entry_count(), 1u);
}

}  // namespace
}  // namespace remesh::cli
