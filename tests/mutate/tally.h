/// Counts the results of cases, stores the findings, and prints both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "tests/mutate/case_run.h"
#include "tests/mutate/child_pool.h"

namespace remesh::mutate {

/// Packs a case's result as text, to be sent from one process to another.
std::string packed(const CaseResult& result);
/// Unpacks a result.
/// Errors: std::runtime_error - the text is not a packed result.
CaseResult unpacked(const std::string& text);

class Tally {
 public:
  /// Input: `folder` - where findings are stored; it is created.
  Tally(std::filesystem::path folder, std::string remesh_program, std::uint64_t seed);

  /// Returns the result that the child sent, or the finding that it crashed.
  static CaseResult result_of(const ChildEnd& end);
  void add(std::uint64_t number, const CaseResult& result, double max_mb);
  /// Writes the mesh of a finding, and how to repeat it.
  void keep(const Case& c, const CaseResult& result) const;
  void print(std::ostream& out) const;
  bool has_findings() const { return !findings_.empty(); }
  std::uint64_t cases() const { return cases_; }

 private:
  struct Kind {
    std::uint64_t count = 0;
    std::vector<std::uint64_t> first;  ///< numbers of cases
    std::string example;
  };

  std::filesystem::path folder_;
  std::string remesh_program_;
  std::uint64_t seed_;
  std::uint64_t cases_ = 0, stopped_ = 0;
  double max_stop_ms_ = 0, max_mb_ = 0, seconds_ = 0;
  std::map<std::string, std::uint64_t> outcomes_;
  std::map<std::string, Kind> findings_;
  std::map<std::string, std::vector<std::uint64_t>> large_;  ///< cases that were slow or ran out of memory
};

}  // namespace remesh::mutate
