#include "api/cli/batch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <vector>

#include "api/cli/failure.h"
#include "api/cli/files.h"
#include "api/cli/progress_bar.h"
#include "api/job.h"
#include "api/negotiation.h"
#include "api/quoting.h"
#include "core/base/error.h"
#include "core/base/number_text.h"
#include "core/io/formats.h"

namespace remesh::cli {
namespace {

namespace fs = std::filesystem;

struct File {
  std::string name;  ///< the path within the folder
  std::uintmax_t size = 0;
  std::string output;  ///< a path; empty if no output is written
  std::string row;     ///< its row of the table, once it is done
};

/// Creates a folder and all its parents.
/// Errors: FileError.
void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError(folder.string() + ": " + error.message());
}

bool is_same_folder(const fs::path& a, const fs::path& b) {
  std::error_code missing;
  return fs::equivalent(a, b, missing);
}

/// Lists the readable files below a folder, sorted by name. Files of an output folder inside it are left out.
std::vector<File> find_files(const std::string& folder, const std::string& output_folder) {
  std::vector<File> files;
  std::error_code error;
  fs::recursive_directory_iterator entries(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entries != fs::recursive_directory_iterator(); entries.increment(error)) {
    std::error_code gone;
    if (entries->is_directory(gone) && is_same_folder(entries->path(), output_folder)) {
      entries.disable_recursion_pending();
    }
    if (!entries->is_regular_file(gone)) continue;
    const auto format = format_from_file_name(entries->path().string());
    if (!format || !api::can_read(*format)) continue;
    files.push_back({entries->path().lexically_relative(folder).string(), entries->file_size(gone), "", ""});
  }
  if (error) throw FileError(folder + ": " + error.message());
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.name < b.name; });
  return files;
}

/// Gives each file a unique name in the output folder.
void name_outputs(std::vector<File>& files, const std::string& folder, std::optional<Format> asked) {
  std::set<std::string> taken;
  for (File& file : files) {
    const Format own = *format_from_file_name(file.name);
    const Format format = asked.value_or(is_written(own) ? own : Format::kObj);
    const std::string ending = "." + std::string(file_ending(format));
    fs::path path = fs::path(folder) / file.name;
    const fs::path with_both = path.string() + ending;
    if (is_gzip_file_name(file.name)) path.replace_extension();
    path.replace_extension(ending);
    if (!taken.insert(path.string()).second) path = with_both;
    taken.insert(path.string());
    file.output = path.string();
  }
}

/// Refuses outputs that would overwrite inputs.
void check_outputs(const std::vector<File>& files, const BatchJob& job) {
  const auto refuse = [](const std::string& why) {
    throw Error(Code::kInvalidOption, Stage::kRead, "--output " + why).for_option("output");
  };
  if (is_same_folder(job.folder, job.output_folder)) {
    refuse(job.output_folder + " is the folder that --batch reads; the results would overwrite its meshes");
  }
  std::error_code missing;
  std::set<fs::path> inputs;
  for (const File& file : files) inputs.insert(fs::weakly_canonical(fs::path(job.folder) / file.name, missing));
  for (const File& file : files) {
    if (inputs.contains(fs::weakly_canonical(file.output, missing)))
      refuse("contains " + file.output + ", which --batch reads and would overwrite");
  }
}

/// Formats a field of a table as one line, in quotes if it needs them (RFC 4180).
std::string field(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return is_control_character(c); }, ' ');
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

constexpr const char* kColumns =
    "file,status,code,faces_in,faces_out,patches,kept,min_angle_deg,max_angle_deg,verified,warnings,seconds,message\n";

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", seconds);
  return text;
}

std::string row_of(const File& file, const Report& report, double seconds) {
  const auto kept = std::count_if(report.patches.begin(), report.patches.end(),
                                  [](const PatchSummary& patch) { return patch.status == PatchStatus::kKept; });
  std::string row = field(file.name) + ",ok,";
  for (const std::string& value :
       {std::to_string(report.input.faces), std::to_string(report.output.faces), std::to_string(report.patches.size()),
        std::to_string(static_cast<std::uint64_t>(kept)), shortest_text(report.output.quality.min_angle_deg),
        shortest_text(report.output.quality.max_angle_deg), std::string(report.verified.all_true() ? "true" : "false"),
        std::to_string(report.diagnostics.size()), seconds_text(seconds)}) {
    row += "," + value;
  }
  if (report.output_origin)
    return row + "," + field("coordinates are relative to " + api::origin_text(*report.output_origin)) + "\n";
  return row + ",\n";
}

std::string row_of(const File& file, const Failure& failure, double seconds) {
  return field(file.name) + ",failed," + field(failure.code) + ",,,,,,,,," + seconds_text(seconds) + "," +
         field(failure.line) + "\n";
}

class BatchRun {
 public:
  BatchRun(const BatchJob& job, RunControl& control)
      : job_(job), control_(control), files_(find_files(job.folder, job.output_folder)) {
    // Threads are first used for files side by side. The remaining threads are used within the files.
    const auto files = static_cast<int>(std::min<std::size_t>(files_.size(), 1u << 20));
    threads_ = std::max(1, std::min(job.limits.workers, files));
    limits_ = job.limits;
    limits_.workers = std::max(1, job.limits.workers / threads_);
    if (!job.output_folder.empty()) {
      name_outputs(files_, job.output_folder, options().options().format);
      check_outputs(files_, job);
    }
    check_writable(job.report);
    if (!job.output_folder.empty() && !files_.empty()) make_folder(job.output_folder);
    // The largest files come first, so that none of them is left to run alone at the end.
    for (File& file : files_) queue_.push_back(&file);
    std::stable_sort(queue_.begin(), queue_.end(), [](const File* a, const File* b) { return a->size > b->size; });
  }

  BatchOutcome run() {
    draft_.emplace(job_.report);
    draft_->append(kColumns);
    {
      const ProgressBar progress([this] { return progress_line(); }, !job_.is_quiet);
      std::vector<std::thread> threads;
      for (int t = 1; t < threads_; ++t) threads.emplace_back([this] { work(); });
      work();
      for (std::thread& thread : threads) thread.join();
    }
    std::string table = kColumns;
    for (const File& file : files_) table += file.row;
    write_file(job_.report, table);
    return {files_.size(), failed_};
  }

 private:
  void work() {
    for (std::size_t next = taken_++; next < queue_.size(); next = taken_++) {
      File& file = *queue_[next];
      const auto start = std::chrono::steady_clock::now();
      const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      };
      try {
        const Report report = remesh_file(file);
        file.row = row_of(file, report, seconds());
      } catch (...) {
        file.row = row_of(file, failure_of(std::current_exception(), file.name), seconds());
        ++failed_;
      }
      const std::lock_guard lock(draft_mutex_);
      draft_->append(file.row);
      ++done_;
    }
  }

  Report remesh_file(const File& file) {
    const std::string path = (fs::path(job_.folder) / file.name).string();
    FileContent content = read_file(path, control_);
    api::Job job;
    job.options = options();
    job.input_format = format_from_file_name(file.name);
    job.mesh = content.view();
    job.release_mesh = [&] { content.release(); };
    api::RemeshAnswer answer = api::run_remesh_job(std::move(job), limits_, control_);
    if (!file.output.empty()) {
      make_folder(fs::path(file.output).parent_path());
      write_file(file.output, answer.body);
    }
    return std::move(answer.report);
  }

  api::OptionReader options() const {
    api::OptionReader options;
    for (const auto& [name, value] : job_.options) options.add(name, value);
    return options;
  }

  std::string progress_line() const {
    const std::size_t done = done_, failed = failed_;
    return progress_bar(static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(1, files_.size()))) +
           std::to_string(done) + " of " + std::to_string(files_.size()) + " files" +
           (failed == 0 ? "" : ", " + std::to_string(failed) + " failed");
  }

  const BatchJob& job_;
  RunControl& control_;  // shared by all files, so that an interrupt ends them all
  std::vector<File> files_;
  std::vector<File*> queue_;
  api::Limits limits_;
  int threads_ = 1;
  std::mutex draft_mutex_;
  std::optional<Draft> draft_;  // the table so far, in the order in which files ended
  std::atomic<std::size_t> taken_{0}, done_{0}, failed_{0};
};

}  // namespace

BatchOutcome run_batch(const BatchJob& job, RunControl& control) { return BatchRun(job, control).run(); }

}  // namespace remesh::cli
