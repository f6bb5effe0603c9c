/// Cases: a mesh, options and what is tried with them; each follows from the seed and its number alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/mutate/corpus.h"
#include "tests/mutate/option_draw.h"

namespace remesh::mutate {

enum class Trial {
  kRemesh,     ///< once, and the answer is judged
  kTwice,      ///< with one worker and with two, whose bytes must be the same
  kCancelled,  ///< stopped after `stop_after_s`
  kAnalysis,
};

struct Case {
  std::uint64_t seed = 0;
  std::uint64_t number = 0;
  std::string origin;  ///< which file, and what was done to it
  std::string bytes;
  Format format = Format::kObj;
  bool is_format_told = true;  ///< else the content tells
  OptionTexts options;
  Trial trial = Trial::kRemesh;
  double stop_after_s = 0;
  int workers = 1;
};

/// Which changes are made.
enum class Mutations { kAny, kNone };

/// Makes a case. Reading the mesh may start threads: not in a process that forks.
/// Holds: the same case for the same corpus, seed and number.
Case make_case(const std::vector<CorpusFile>& corpus, std::uint64_t seed, std::uint64_t number, Mutations mutations);

/// `obj`, ...: the ending under which the command line reads such a file.
std::string file_ending(const Case& c);

}  // namespace remesh::mutate
