#include "tests/mutate/case_source.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "api/json_reader.h"
#include "core/io/mesh_files.h"
#include "tests/mutate/byte_mutations.h"
#include "tests/mutate/soup_mutations.h"

namespace remesh::mutate {
namespace {

constexpr std::size_t kMaxFaces = 20'000;
constexpr std::size_t kMaxBytes = 2'000'000;

/// Mixes a number so that the results of neighbouring numbers look unrelated.
/// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014 (the finalizer of SplitMix).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Draws a file. Smaller files are drawn more often, so that more cases run in the same time.
const CorpusFile& draw_file(const std::vector<CorpusFile>& corpus, Random& random) {
  const double u = random.unit();
  return corpus[static_cast<std::size_t>(u * u * static_cast<double>(corpus.size()))];
}

std::optional<PolygonSoup> read_soup(const std::string& bytes, Format format) {
  try {
    RunControl control;
    api::OptionReader options;
    const ReadResult read =
        format == Format::kJson ? api::read_json(bytes, {}, control, options) : read_mesh(format, bytes, {}, control);
    return soup_of(read.mesh);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Changes the file as a mesh and writes it in any format.
void mutate_as_mesh(Case& c, PolygonSoup soup, const std::vector<CorpusFile>& corpus, Random& random) {
  if (random.chance(0.15)) {
    const CorpusFile& second = draw_file(corpus, random);
    std::optional<PolygonSoup> other = read_soup(second.bytes, second.format);
    if (other && soup.faces.size() + other->faces.size() < kMaxFaces) {
      merge_soup(soup, std::move(*other), random);
      c.origin += "; merged with " + second.name;
    }
  }
  const int changes = random.below(4) + (c.origin.find("; ") == std::string::npos ? 1 : 0);
  for (int i = 0; i < changes && soup.faces.size() < kMaxFaces; ++i) c.origin += "; " + mutate_soup(soup, random);
  const SoupFormat format =
      random.chance(0.4) ? SoupFormat::kObj : static_cast<SoupFormat>(random.below(kSoupFormatCount));
  c.format = format_of(format);
  c.bytes = write_soup(soup, format);
}

void mutate(Case& c, const std::vector<CorpusFile>& corpus, Random& random) {
  const double kind = random.unit();
  if (kind < 0.05) return;  // only the options are drawn
  if (kind < 0.8) {
    std::optional<PolygonSoup> soup = read_soup(c.bytes, c.format);
    if (soup && !soup->positions.empty()) mutate_as_mesh(c, std::move(*soup), corpus, random);
    if (kind < 0.65) return;
  }
  const int changes = 1 << std::max(0, random.below(5) - 2);
  for (int i = 0; i < changes; ++i) c.origin += "; " + mutate_bytes(c.bytes, random);
  if (c.bytes.size() > kMaxBytes) c.bytes.resize(kMaxBytes);
}

double diagonal_of(const Case& c) {
  const std::optional<PolygonSoup> soup = read_soup(c.bytes, c.format);
  if (!soup) return 1;
  const double diagonal = box_of(*soup).diagonal();
  return std::isfinite(diagonal) && diagonal > 0 ? diagonal : 1;
}

void draw_trial(Case& c, Random& random) {
  const double kind = random.unit();
  c.workers = random.chance(0.1) ? 2 : 1;
  if (kind < 0.12) {
    c.trial = Trial::kCancelled;
    c.stop_after_s = std::pow(10.0, random.uniform(-3.5, 0));
  } else if (kind < 0.2) {
    c.trial = Trial::kTwice;
  } else if (kind < 0.25) {
    c.trial = Trial::kAnalysis;
  }
}

}  // namespace

Case make_case(const std::vector<CorpusFile>& corpus, std::uint64_t seed, std::uint64_t number, Mutations mutations) {
  Random random(mixed(seed ^ mixed(number)));
  Case c;
  c.seed = seed;
  c.number = number;
  const CorpusFile& file = draw_file(corpus, random);
  c.origin = file.name;
  c.bytes = file.bytes;
  c.format = file.format;
  if (mutations == Mutations::kAny) mutate(c, corpus, random);
  c.is_format_told = random.chance(0.9);
  c.options = draw_options(random, diagonal_of(c));
  draw_trial(c, random);
  return c;
}

std::string file_ending(const Case& c) {
  return c.is_format_told ? std::string(format_name(c.format)) : std::string("mesh");
}

}  // namespace remesh::mutate
