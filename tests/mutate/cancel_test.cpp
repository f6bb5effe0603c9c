/// Usage: cancel_test [--runs N] [--seed N] [--group N] [--limit MS] [--median-limit MS] [--stand-limit MS]
///                    [--clock wall|processor] ...
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "api/job.h"
#include "api/request_code.h"
#include "tests/mutate/case_source.h"
#include "tests/mutate/child_pool.h"
#include "tests/mutate/corpus.h"
#include "tests/mutate/flags.h"
#include "tests/mutate/hostile_meshes.h"
#include "tests/mutate/timed_run.h"

namespace remesh::mutate {
namespace {

/// Has a time that a caller had to wait: from a stop to the end of the run, or while progress stood.
struct Wait {
  std::string stage;
  double after_s = 0, wall_ms = 0, busy_ms = 0;
};

/// This is told of one run.
struct Record {
  std::uint64_t group = 0;
  std::string subject;  ///< the mesh and options of the run
  std::string ending;
  bool was_stopped = false;
  Wait stop;   ///< if it was stopped
  Wait stand;  ///< the longest
};

struct Plan {
  std::uint64_t runs, seed;
  int stops_of_group;
  double max_run_s, patience_s, hostile_part, size, limit_ms, median_limit_ms, stand_limit_ms;
  std::size_t max_mb;
  std::string kind;  ///< a word of the names of hostile meshes
  bool is_by_wall;
  std::filesystem::path folder;
};

/// The work of one child. It runs one mesh with its options once, to the end or for `max_run_s`. Then it runs them
/// again a few times and stops each run at a moment that is drawn evenly from the time of the first run.
class Group {
 public:
  Group(const Plan& plan, const std::vector<CorpusFile>& corpus, std::uint64_t number)
      : plan_(plan), number_(number), random_(plan.seed * 1'000'003 + number) {
    if (random_.chance(plan.hostile_part)) {
      case_ = make_hostile_case(plan.size, plan.kind, random_);
    } else {
      case_ = make_case(corpus, plan.seed, number, Mutations::kAny);
    }
    limits_.workers = case_.workers;
  }

  const Case& subject() const { return case_; }
  std::string words() const {
    return case_.origin + " as " + std::string(format_name(case_.format)) + "; " + as_flags(case_.options) +
           "; workers " + std::to_string(case_.workers);
  }

  /// Calls told(record) after each run.
  template <class Told>
  void run(const Told& told) {
    const RunEnd whole = run_once(plan_.max_run_s);
    told(record_of(whole, plan_.max_run_s));
    if (whole.ending == Ending::kNever) return;
    // A run that ends at once tells nothing. Most of these are refused.
    constexpr double kMinRun = 0.003;
    const double length_s = std::min(whole.wall_s, plan_.max_run_s);
    if (length_s < kMinRun) return;
    for (int i = 0; i < plan_.stops_of_group; ++i) {
      const double after_s = random_.unit() * length_s;
      const RunEnd end = run_once(after_s);
      told(record_of(end, after_s));
      if (end.ending == Ending::kNever) return;
    }
  }

 private:
  RunEnd run_once(double stop_after_s) const {
    return run_watched(
        [this](RunControl& control) {
          api::Job job;
          job.mesh = case_.bytes;
          if (case_.is_format_told) job.input_format = case_.format;
          for (const auto& [name, value] : case_.options) job.options.add(name, value);
          api::run_remesh_job(std::move(job), limits_, control);
        },
        stop_after_s, plan_.patience_s, case_.workers);
  }

  Record record_of(const RunEnd& end, double stop_after_s) const {
    Record record;
    record.group = number_;
    record.subject = words();
    record.was_stopped = end.was_stopped;
    record.stop = {std::string(stage_name(end.stage)), stop_after_s, end.stop_wall_ms, end.stop_busy_ms};
    const Stand& stand = end.longest_stand;
    record.stand = {std::string(stage_name(stand.stage)), stand.after_s, 1e3 * stand.wall_s, 1e3 * stand.busy_s};
    switch (end.ending) {
      case Ending::kDone: record.ending = "done"; break;
      case Ending::kRefused: record.ending = api::error_name(*end.error); break;
      case Ending::kOutOfMemory: record.ending = "out_of_memory"; break;
      case Ending::kStrange: record.ending = end.strange; break;
      case Ending::kNever: record.ending = "never"; break;
    }
    return record;
  }

  const Plan& plan_;
  std::uint64_t number_;
  Random random_;
  Case case_;
  api::Limits limits_;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Wait, stage, after_s, wall_ms, busy_ms)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Record, group, subject, ending, was_stopped, stop, stand)

std::string packed(const Record& record) {
  return nlohmann::json(record).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::vector<Record> unpacked(const std::string& text) {
  std::vector<Record> records;
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    records.push_back(nlohmann::json::parse(text.substr(begin, end - begin)).get<Record>());
  }
  return records;
}

std::ostream& operator<<(std::ostream& out, const Wait& wait) {
  return out << wait.wall_ms << " ms (" << wait.busy_ms << " ms of the processor)";
}

void print_stop(const Record& run) {
  std::cout << "group " << run.group << ": " << run.stop << " after a stop at " << run.stop.after_s << " s in "
            << run.stop.stage << ", then " << run.ending << ": " << run.subject << std::endl;
}

void print_stand(const Record& run) {
  std::cout << "group " << run.group << ": progress stood for " << run.stand << " from " << run.stand.after_s
            << " s in " << run.stand.stage << ": " << run.subject << std::endl;
}

double at_part(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double place = part * static_cast<double>(values.size());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(place))];
}

class Statistics {
 public:
  explicit Statistics(const Plan& plan) : plan_(plan) {}

  double measure(const Wait& wait) const { return plan_.is_by_wall ? wait.wall_ms : wait.busy_ms; }
  void add(const Record& run) {
    stands_.push_back(run.stand);
    if (measure(run.stand) > plan_.stand_limit_ms) print_stand(run);
    if (!run.was_stopped) return;
    stops_.push_back(run.stop);
    if (measure(run.stop) > plan_.limit_ms) print_stop(run);
  }
  void add_crash(const ChildEnd& end) {
    ++crashes_;
    std::cout << "group " << end.number << (end.was_killed ? ": had to be killed. " : ": crashed. ")
              << end.standard_error << std::endl;
  }
  std::size_t count() const { return stops_.size(); }

  /// Output: true if the times stay within the bounds.
  bool print_tables() const {
    std::cout << "\nseed " << plan_.seed << "; times in ms, by "
              << (plan_.is_by_wall ? "the clock on the wall" : "time of the processor") << "\n";
    table("from the stop to the end", stops_, plan_.limit_ms);
    table("longest stand of progress", stands_, plan_.stand_limit_ms);
    const double median = at_part(times(stops_), 0.5), longest = at_part(times(stops_), 1);
    const double stand = at_part(times(stands_), 1);
    const bool holds =
        median <= plan_.median_limit_ms && longest <= plan_.limit_ms && stand <= plan_.stand_limit_ms && crashes_ == 0;
    std::cout << (holds ? "holds" : "DOES NOT HOLD") << ": a run ends within " << plan_.median_limit_ms
              << " ms in the median and " << plan_.limit_ms << " ms always, and progress stands for at most "
              << plan_.stand_limit_ms << " ms; " << crashes_ << " crashes\n";
    return holds;
  }

 private:
  std::vector<double> times(const std::vector<Wait>& waits) const {
    std::vector<double> result;
    for (const Wait& wait : waits) result.push_back(measure(wait));
    return result;
  }
  void table(const std::string& title, const std::vector<Wait>& waits, double limit_ms) const {
    std::map<std::string, std::vector<Wait>> by_stage;
    for (const Wait& wait : waits) by_stage[wait.stage].push_back(wait);
    std::cout << std::left << std::setw(28) << title << std::right;
    for (const char* column : {"runs", "median", "99 %", "max", "over"}) std::cout << std::setw(10) << column;
    std::cout << "\n";
    for (const auto& [stage, of_stage] : by_stage) row(stage, times(of_stage), limit_ms);
    row("all", times(waits), limit_ms);
  }
  void row(const std::string& name, const std::vector<double>& values, double limit_ms) const {
    const auto over = std::count_if(values.begin(), values.end(), [&](double v) { return v > limit_ms; });
    std::cout << std::left << std::setw(28) << name << std::right << std::fixed << std::setprecision(1) << std::setw(10)
              << values.size();
    for (const double part : {0.5, 0.99, 1.0}) std::cout << std::setw(10) << at_part(values, part);
    std::cout << std::setw(10) << over << std::defaultfloat << "\n";
  }

  const Plan& plan_;
  std::vector<Wait> stops_, stands_;
  std::uint64_t crashes_ = 0;
};

int run_all(const Plan& plan, const std::vector<CorpusFile>& corpus) {
  const double max_life_s = (1 + plan.stops_of_group) * (plan.max_run_s + plan.patience_s) + 120;
  Statistics statistics(plan);
  for (std::uint64_t number = 0; statistics.count() < plan.runs; ++number) {
    // Only one child runs at a time, because times are measured.
    ChildPool pool(1, plan.max_mb, max_life_s);
    pool.start(number, [&](const Send& send) {
      Group(plan, corpus, number).run([&](const Record& run) { send(packed(run)); });
    });
    const ChildEnd end = pool.wait();
    for (const Record& run : unpacked(end.message)) statistics.add(run);
    if (end.signal != 0) statistics.add_crash(end);
  }
  return statistics.print_tables() ? 0 : 1;
}

/// Runs the group in this process, and stores its mesh.
int run_group(const Plan& plan, const std::vector<CorpusFile>& corpus, std::uint64_t number) {
  Group group(plan, corpus, number);
  std::filesystem::create_directories(plan.folder);
  const auto mesh = plan.folder / ("stopped-" + std::to_string(plan.seed) + "-" + std::to_string(number) + "." +
                                   file_ending(group.subject()));
  std::ofstream(mesh, std::ios::binary) << group.subject().bytes;
  std::cout << group.words() << "\nits mesh is in " << mesh.string() << std::endl;
  Statistics statistics(plan);
  group.run([&](const Record& run) {
    print_stand(run);
    if (run.was_stopped) print_stop(run);
    statistics.add(run);
  });
  return statistics.print_tables() ? 0 : 1;
}

int run(int argc, char** argv) {
  const Flags flags(argc, argv,
                    {{"runs", "2000"},
                     {"seed", "36"},
                     {"group", ""},
                     {"stops", "4"},
                     {"limit", "200"},
                     {"median-limit", "100"},
                     {"stand-limit", "1000"},
                     {"clock", "wall"},
                     {"max-run", "6"},
                     {"patience", "10"},
                     {"hostile", "0.4"},
                     {"kind", ""},
                     {"size", "1"},
                     {"memory", "8192"},
                     {"found", "found"}});
  Plan plan;
  plan.runs = flags.integer("runs");
  plan.seed = flags.integer("seed");
  plan.stops_of_group = static_cast<int>(flags.integer("stops"));
  plan.max_run_s = flags.number("max-run");
  plan.patience_s = flags.number("patience");
  plan.hostile_part = flags.number("hostile");
  plan.kind = flags.text("kind");
  plan.size = flags.number("size");
  plan.limit_ms = flags.number("limit");
  plan.median_limit_ms = flags.number("median-limit");
  plan.max_mb = static_cast<std::size_t>(flags.integer("memory"));
  plan.stand_limit_ms = flags.number("stand-limit");
  plan.is_by_wall = flags.text("clock") == "wall";
  plan.folder = flags.text("found");
  constexpr std::size_t kMaxBytes = 400'000;
  const std::vector<CorpusFile> corpus = load_corpus(kMaxBytes);
  std::cout << "REMESH_SEED=" << plan.seed << ", " << corpus.size() << " files" << std::endl;
  if (flags.is_set("group")) return run_group(plan, corpus, flags.integer("group"));
  return run_all(plan, corpus);
}

}  // namespace
}  // namespace remesh::mutate

int main(int argc, char** argv) {
  try {
    return remesh::mutate::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "cancel_test: " << error.what() << "\n";
    return 2;
  }
}
