#include "tests/mutate/tally.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <utility>

namespace remesh::mutate {
namespace {

constexpr std::size_t kShown = 12;

std::string stem_of(const Case& c) { return "mutate-" + std::to_string(c.seed) + "-" + std::to_string(c.number); }

}  // namespace

std::string packed(const CaseResult& result) {
  nlohmann::json findings = nlohmann::json::array();
  for (const Objection& finding : result.findings) findings.push_back({finding.kind, finding.text});
  const nlohmann::json document{{"outcome", result.outcome},
                                {"seconds", result.seconds},
                                {"stop_busy_ms", result.stop_busy_ms},
                                {"findings", findings}};
  return document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

CaseResult unpacked(const std::string& text) {
  try {
    const nlohmann::json document = nlohmann::json::parse(text);
    CaseResult result;
    result.outcome = document.at("outcome");
    result.seconds = document.at("seconds");
    result.stop_busy_ms = document.at("stop_busy_ms");
    for (const auto& finding : document.at("findings")) result.findings.push_back({finding.at(0), finding.at(1)});
    return result;
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(error.what());
  }
}

Tally::Tally(std::filesystem::path folder, std::string remesh_program, std::uint64_t seed)
    : folder_(std::move(folder)), remesh_program_(std::move(remesh_program)), seed_(seed) {
  std::filesystem::create_directories(folder_);
}

CaseResult Tally::result_of(const ChildEnd& end) {
  try {
    return unpacked(end.message);
  } catch (const std::runtime_error&) {
  }
  CaseResult result;
  if (end.was_killed) {
    result.outcome = "hang";
    result.findings.push_back({"hang", "it had to be killed. " + end.standard_error});
  } else {
    result.outcome = "crash";
    const std::string signal = end.signal == 0 ? "without a signal" : std::string("by ") + strsignal(end.signal);
    result.findings.push_back({"crash", "it ended " + signal + ". " + end.standard_error});
  }
  return result;
}

void Tally::add(std::uint64_t number, const CaseResult& result, double max_mb) {
  ++cases_;
  ++outcomes_[result.outcome];
  seconds_ += result.seconds;
  max_mb_ = std::max(max_mb_, max_mb);
  if (result.stop_busy_ms > 0) ++stopped_;
  max_stop_ms_ = std::max(max_stop_ms_, result.stop_busy_ms);
  if (result.outcome == "slow" || result.outcome == "out_of_memory") large_[result.outcome].push_back(number);
  for (const Objection& finding : result.findings) {
    Kind& kind = findings_[finding.kind];
    if (kind.count++ == 0) kind.example = finding.text;
    if (kind.first.size() < kShown) kind.first.push_back(number);
  }
}

void Tally::keep(const Case& c, const CaseResult& result) const {
  const std::string mesh = (folder_ / (stem_of(c) + "." + file_ending(c))).string();
  std::ofstream(mesh, std::ios::binary) << c.bytes;
  std::ofstream note(folder_ / (stem_of(c) + ".txt"));
  for (const Objection& finding : result.findings) note << finding.kind << ": " << finding.text << "\n";
  note << "made from: " << c.origin << "\n";
  if (c.trial == Trial::kCancelled) note << "stopped after " << c.stop_after_s << " s\n";
  note << "once more: ./dev fuzz mutate --case " << c.number << " --seed " << c.seed << "\n";
  const bool has_format =
      std::any_of(c.options.begin(), c.options.end(), [](const auto& o) { return o.first == "format"; });
  note << "command line: " << remesh_program_ << " " << mesh << " -o /tmp/out"
       << (has_format ? "" : "." + std::string(format_name(c.format))) << " " << as_flags(c.options) << "\n";
}

void Tally::print(std::ostream& out) const {
  const auto row = [&](const std::string& name, std::uint64_t count) {
    out << "  " << std::left << std::setw(34) << name << std::right << std::setw(9) << count << "\n";
  };
  out << "\nseed " << seed_ << "\n";
  row("cases", cases_);
  for (const auto& [name, count] : outcomes_) row(name, count);
  out << "  longest life after a stop, in time of the processor: " << max_stop_ms_ << " ms of " << stopped_
      << " stops; largest process: " << max_mb_ << " MB; runs took " << seconds_ << " s\n";
  for (const auto& [name, numbers] : large_) {
    out << "  " << name << ", no finding:";
    for (std::size_t i = 0; i < std::min(numbers.size(), kShown); ++i) out << " " << numbers[i];
    out << (numbers.size() > kShown ? " ...\n" : "\n");
  }
  std::uint64_t findings = 0;
  for (const auto& [name, kind] : findings_) findings += kind.count;
  row("findings", findings);
  for (const auto& [name, kind] : findings_) {
    row("- " + name, kind.count);
    out << "      cases:";
    for (const std::uint64_t number : kind.first) out << " " << number;
    out << "\n      the first: " << kind.example << "\n";
  }
  if (!findings_.empty()) out << "  kept in " << folder_.string() << "\n";
}

}  // namespace remesh::mutate
