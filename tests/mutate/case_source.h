/// Makes cases. A case is a mesh, options and a trial. It follows from the seed and its number alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/mutate/corpus.h"
#include "tests/mutate/option_draw.h"

namespace remesh::mutate {

enum class Trial {
  kRemesh,     ///< it is remeshed once, and the answer is judged
  kTwice,      ///< it is remeshed with one worker and with two; the bytes must be equal
  kCancelled,  ///< it is stopped after `stop_after_s`
  kAnalysis,
};

struct Case {
  std::uint64_t seed = 0;
  std::uint64_t number = 0;
  std::string origin;  ///< the name of the file and what was done to it
  std::string bytes;
  Format format = Format::kObj;
  bool is_format_told = true;  ///< false: the content tells the format
  OptionTexts options;
  Trial trial = Trial::kRemesh;
  double stop_after_s = 0;
  int workers = 1;
};

/// The changes that may be made.
enum class Mutations { kAny, kNone };

/// Makes a case. Reading the mesh may start threads, so a process that forks must not call it.
/// Holds: the same corpus, seed and number give the same case.
Case make_case(const std::vector<CorpusFile>& corpus, std::uint64_t seed, std::uint64_t number, Mutations mutations);

/// Returns the ending with which the command line reads such a file: `obj`, ...
std::string file_ending(const Case& c);

}  // namespace remesh::mutate
