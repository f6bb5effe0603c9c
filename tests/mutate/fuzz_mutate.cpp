/// Usage: mutate_fuzz [SECONDS] [--seed N] [--first N] [--cases N] [--case N] [--jobs N] [--mutations any|none] ...
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/mutate/case_run.h"
#include "tests/mutate/child_pool.h"
#include "tests/mutate/corpus.h"
#include "tests/mutate/flags.h"
#include "tests/mutate/tally.h"
#include "tests/support/sanitizer.h"

namespace remesh::mutate {
namespace {

using Clock = std::chrono::steady_clock;

struct Plan {
  double seconds;
  std::uint64_t seed, first, cases;
  std::size_t jobs, max_mb;
  Mutations mutations;
  TryLimits limits;
  std::filesystem::path folder;
  std::string remesh_program;
};

/// Makes a case and runs it. This must happen in a child: reading may start threads, which the parent must not have.
CaseResult run_one(const Plan& plan, const std::vector<CorpusFile>& corpus, const Tally& tally, std::uint64_t number) {
  const Case c = make_case(corpus, plan.seed, number, plan.mutations);
  CaseResult result = try_case(c, plan.limits);
  if (!result.findings.empty()) tally.keep(c, result);
  return result;
}

/// Stores a case that has crashed before it could be stored. Another child makes the case again and only writes it.
void keep_crashed(const Plan& plan, const std::vector<CorpusFile>& corpus, const Tally& tally, std::uint64_t number,
                  const CaseResult& result) {
  constexpr double kMaxSeconds = 60;
  ChildPool pool(1, 0, kMaxSeconds);
  pool.start(number, [&](const Send&) { tally.keep(make_case(corpus, plan.seed, number, plan.mutations), result); });
  pool.wait();
}

int run_many(const Plan& plan, const std::vector<CorpusFile>& corpus) {
  const TryLimits& limits = plan.limits;
  // A case may run twice, and it is also made and judged in that time.
  ChildPool pool(plan.jobs, plan.max_mb, 2 * (limits.time_s + limits.patience_s) + 60);
  Tally tally(plan.folder, plan.remesh_program, plan.seed);
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(plan.seconds));
  std::uint64_t next = plan.first;
  for (;;) {
    const bool is_more_wanted = Clock::now() < end && next - plan.first < plan.cases;
    if (is_more_wanted && !pool.is_full()) {
      const std::uint64_t number = next++;
      pool.start(number, [&, number](const Send& send) { send(packed(run_one(plan, corpus, tally, number))); });
      continue;
    }
    if (pool.is_empty()) break;
    const ChildEnd child = pool.wait();
    const CaseResult result = Tally::result_of(child);
    tally.add(child.number, result, child.max_mb);
    if (result.outcome == "crash" || child.was_killed) keep_crashed(plan, corpus, tally, child.number, result);
    for (const Objection& finding : result.findings)
      std::cout << "case " << child.number << ": " << finding.kind << ": " << finding.text << std::endl;
  }
  tally.print(std::cout);
  return tally.has_findings() ? 1 : 0;
}

/// Runs the case in this process, so that a debugger can follow it.
int run_single(const Plan& plan, const std::vector<CorpusFile>& corpus, std::uint64_t number) {
  const Tally tally(plan.folder, plan.remesh_program, plan.seed);
  const Case c = make_case(corpus, plan.seed, number, plan.mutations);
  CaseResult none;
  none.findings.push_back({"run alone", "it was asked for"});
  tally.keep(c, none);
  std::cout << "case " << number << " of seed " << plan.seed << ": " << c.origin << "\n"
            << c.bytes.size() << " bytes of " << format_name(c.format) << (c.is_format_told ? "" : ", not told") << "; "
            << as_flags(c.options) << "; " << c.workers << " workers\n"
            << "mesh and command line are in " << plan.folder.string() << std::endl;
  const CaseResult result = try_case(c, plan.limits);
  std::cout << result.outcome << " after " << result.seconds << " s";
  if (result.stop_busy_ms > 0) std::cout << ", " << result.stop_busy_ms << " ms after a stop";
  std::cout << "\n";
  for (const Objection& finding : result.findings) std::cout << finding.kind << ": " << finding.text << "\n";
  if (!result.findings.empty()) tally.keep(c, result);
  return result.findings.empty() ? 0 : 1;
}

int run(int argc, char** argv) {
  const Flags flags(argc, argv,
                    {{"seed", "36"},
                     {"first", "0"},
                     {"cases", ""},
                     {"case", ""},
                     {"jobs", "1"},
                     {"memory", "4096"},
                     {"time-limit", kIsSanitized ? "120" : "20"},
                     {"busy-limit", kIsSanitized ? "100" : "10"},
                     {"stop-limit", kIsSanitized ? "5000" : "200"},
                     {"max-bytes", "200000"},
                     {"mutations", "any"},
                     {"found", "found"},
                     {"remesh", "remesh"}});
  Plan plan;
  plan.seconds = flags.words().empty() ? 60 : std::stod(flags.words().front());
  plan.seed = flags.integer("seed");
  plan.first = flags.integer("first");
  plan.cases = flags.is_set("cases") ? flags.integer("cases") : std::numeric_limits<std::uint64_t>::max();
  plan.jobs = static_cast<std::size_t>(flags.integer("jobs"));
  plan.max_mb = static_cast<std::size_t>(flags.integer("memory"));
  plan.mutations = flags.text("mutations") == "none" ? Mutations::kNone : Mutations::kAny;
  plan.limits.time_s = flags.number("time-limit");
  plan.limits.busy_s = flags.number("busy-limit");
  plan.limits.stop_ms = flags.number("stop-limit");
  plan.folder = flags.text("found");
  plan.remesh_program = flags.text("remesh");
  const std::vector<CorpusFile> corpus = load_corpus(static_cast<std::size_t>(flags.integer("max-bytes")));
  std::cout << "REMESH_SEED=" << plan.seed << ", " << corpus.size() << " files" << std::endl;
  if (flags.is_set("case")) return run_single(plan, corpus, flags.integer("case"));
  return run_many(plan, corpus);
}

}  // namespace
}  // namespace remesh::mutate

int main(int argc, char** argv) {
  try {
    return remesh::mutate::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "mutate_fuzz: " << error.what() << "\n";
    return 2;
  }
}
