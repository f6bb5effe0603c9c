/// Judges recognition and remeshing by solids that are drawn at random, of which everything is known.
/// Usage: drawn_table [N] [--bores N] [--seed S] [--case N] [--bore-case N] [--faults N] [--only-circle] [--short]
///   N        so many solids (2000), each with 16 elements per circle and with the options for volume meshing
///   --bores  so many bores, corners and fillets (400)
///   --case, --bore-case  judges one solid alone, and writes its mesh and its truth: drawn-N.obj, drawn-N.truth.tsv
///   --faults tells of so many faults (20)
///   --only-circle  leaves out the options for volume meshing
///   --short  few solids with 16 elements per circle, which are held only to what no single solid may break
/// Exit code: 0 - all bounds hold; 1 - the bounds that do not hold are listed; 2 - usage.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/recognition/drawn_judge.h"
#include "tests/recognition/drawn_solid.h"

namespace remesh::recognition {
namespace {

constexpr double kMinFoundPercent = 97;
constexpr double kMaxWrongPercent = 0.2;

struct DrawnSettings {
  std::uint64_t solids = 2000, bores = 400, seed = 58;
  long long only = -1, only_bore = -1;
  std::size_t faults = 20;
  bool want_volume = true;
  bool is_short = false;
};

struct DrawnSums {
  std::map<std::string, DrawnCounts> by_name, by_rounding;
  DrawnCounts all;
  std::size_t solids = 0, failed = 0, remeshed = 0, moved = 0, unexplained = 0, volumes = 0;
  std::vector<std::string> faults;

  void add(const DrawnSolid& solid, const DrawnVerdict& verdict, const std::string& which) {
    ++solids;
    failed += verdict.error.empty() ? 0 : 1;
    remeshed += verdict.remeshed;
    moved += verdict.moved;
    unexplained += verdict.unexplained;
    volumes += verdict.is_volume_right ? 0 : 1;
    for (const auto& [name, counts] : verdict.by_name) {
      by_name[name].add(counts);
      const bool is_expected = name != "plane" && !name.starts_with("coarse ");
      if (is_expected) by_rounding[solid.rounding.substr(0, solid.rounding.find(','))].add(counts);
      for (const char* word : {"far", "plain", "sloppy"})
        if (is_expected && solid.rounding.find(word) != std::string::npos) by_rounding[word].add(counts);
      all.add(counts);
    }
    for (const std::string& fault : verdict.faults)
      faults.push_back(which + " (" + solid.part + ", " + solid.rounding + "): " + fault);
  }
};

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

void print_rows(const std::map<std::string, DrawnCounts>& rows, const char* title) {
  std::printf("  %-16s %9s %9s %9s %9s %9s\n", title, "surfaces", "found", "missed", "off", "wrong");
  for (const auto& [name, c] : rows)
    std::printf("  %-16s %9zu %8.2f%% %8.2f%% %8.2f%% %8.2f%%\n", name.c_str(), c.surfaces, share(c.found, c.surfaces),
                share(c.missed, c.surfaces), share(c.off, c.surfaces), share(c.wrong, c.surfaces));
}

void print_sums(const DrawnSums& sums, const std::string& title, std::size_t most_faults) {
  std::printf(
      "\n%s: %zu solids, %zu failed; %zu surfaces remeshed, %zu farther than told, %zu farther than explained; "
      "%zu volumes beyond what is told\n",
      title.c_str(), sums.solids, sums.failed, sums.remeshed, sums.moved, sums.unexplained, sums.volumes);
  print_rows(sums.by_name, "surface");
  print_rows(sums.by_rounding, "rounding");
  std::printf("  wrong kind %zu, off %zu of %zu surfaces (%.3f %%, %.3f %%)\n", sums.all.wrong, sums.all.off,
              sums.all.surfaces, share(sums.all.wrong, sums.all.surfaces), share(sums.all.off, sums.all.surfaces));
  for (std::size_t i = 0; i < std::min(most_faults, sums.faults.size()); ++i)
    std::printf("  - %s\n", sums.faults[i].c_str());
  if (sums.faults.size() > most_faults) std::printf("  - and %zu more\n", sums.faults.size() - most_faults);
  std::fflush(stdout);
}

/// Lists what the bounds do not allow.
/// Input: `is_short` - only what no solid may break is asked: a few solids say nothing about shares.
void hold_to_bounds(const DrawnSums& sums, const std::string& title, bool are_bores, bool is_short,
                    std::vector<std::string>& broken) {
  const auto demand = [&](bool holds, const std::string& what) {
    if (!holds) broken.push_back(title + ": " + what);
  };
  demand(sums.failed == 0, std::to_string(sums.failed) + " runs failed");
  demand(sums.moved == 0, std::to_string(sums.moved) + " surfaces are farther than told");
  demand(sums.volumes == 0, std::to_string(sums.volumes) + " volumes have changed by more than told");
  demand(sums.remeshed > 0, "no surface is remeshed, so that nothing is judged");
  if (is_short) return;
  demand(sums.unexplained == 0, std::to_string(sums.unexplained) + " surfaces are farther than their chords explain");
  if (!are_bores) {
    demand(share(sums.all.wrong, sums.all.surfaces) <= kMaxWrongPercent, "too many kinds are wrong");
    return;
  }
  DrawnCounts curved;
  for (const auto& [name, counts] : sums.by_name)
    if (name != "plane" && !name.starts_with("coarse ")) curved.add(counts);
  demand(share(curved.found, curved.surfaces) >= kMinFoundPercent, "too few are found");
  demand(sums.all.wrong + sums.all.off == 0, "something wrong is claimed");
}

int judge_one(const DrawnSolid& solid, const std::string& name) {
  write_solid(solid, name);
  std::printf("%s.obj: %s, %s, %zu faces\n", name.c_str(), solid.part.c_str(), solid.rounding.c_str(),
              solid.model.mesh.face_count());
  std::vector<std::string> broken;
  for (const auto& [title, options] :
       {std::pair{"16 elements per circle", circle_options(16)}, std::pair{"for volume meshing", volume_options()}}) {
    DrawnSums sums;
    sums.add(solid, judge_solid(solid, options), name);
    print_sums(sums, title, 1000);
    if (!sums.faults.empty()) broken.push_back(title);
  }
  return broken.empty() ? 0 : 1;
}

int usage() {
  std::fprintf(stderr,
               "usage: drawn_table [N] [--bores N] [--seed S] [--case N] [--bore-case N] [--faults N] "
               "[--only-circle] [--short]\n");
  return 2;
}

int run_drawn(const std::vector<std::string>& arguments) {
  DrawnSettings settings;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const auto number = [&] {
      return i + 1 < arguments.size() ? std::strtoull(arguments[++i].c_str(), nullptr, 10) : 0;
    };
    if (word == "--bores") {
      settings.bores = number();
    } else if (word == "--seed") {
      settings.seed = number();
    } else if (word == "--case") {
      settings.only = static_cast<long long>(number());
    } else if (word == "--bore-case") {
      settings.only_bore = static_cast<long long>(number());
    } else if (word == "--faults") {
      settings.faults = number();
    } else if (word == "--only-circle") {
      settings.want_volume = false;
    } else if (word == "--short") {
      settings.is_short = true;
      settings.want_volume = false;
      settings.solids = 16;
      settings.bores = 20;
    } else if (!word.empty() && word.find_first_not_of("0123456789") == std::string::npos) {
      settings.solids = std::strtoull(word.c_str(), nullptr, 10);
    } else {
      return usage();
    }
  }
  if (settings.only >= 0) {
    const auto n = static_cast<std::uint64_t>(settings.only);
    return judge_one(drawn_solid(settings.seed, n), "drawn-" + std::to_string(n));
  }
  if (settings.only_bore >= 0) {
    const auto n = static_cast<std::uint64_t>(settings.only_bore);
    return judge_one(drawn_bore(settings.seed, n), "drawn-bore-" + std::to_string(n));
  }
  std::vector<std::string> broken;
  std::printf("seed %llu\n", static_cast<unsigned long long>(settings.seed));
  if (settings.bores > 0) {
    DrawnSums sums;
    for (std::uint64_t n = 0; n < settings.bores; ++n) {
      const DrawnSolid solid = drawn_bore(settings.seed, n);
      sums.add(solid, judge_solid(solid, circle_options(16)), "bore case " + std::to_string(n));
    }
    print_sums(sums, "bores, corners and fillets", settings.faults);
    hold_to_bounds(sums, "bores", true, settings.is_short, broken);
  }
  if (settings.solids > 0) {
    DrawnSums circle, volume;
    for (std::uint64_t n = 0; n < settings.solids; ++n) {
      const DrawnSolid solid = drawn_solid(settings.seed, n);
      const std::string which = "case " + std::to_string(n);
      circle.add(solid, judge_solid(solid, circle_options(16)), which);
      if (settings.want_volume) volume.add(solid, judge_solid(solid, volume_options()), which);
    }
    print_sums(circle, "solids with 16 elements per circle", settings.faults);
    hold_to_bounds(circle, "16 elements per circle", false, settings.is_short, broken);
    if (settings.want_volume) {
      print_sums(volume, "solids for volume meshing", settings.faults);
      hold_to_bounds(volume, "for volume meshing", false, settings.is_short, broken);
    }
  }
  std::printf("\n%zu bounds do not hold\n", broken.size());
  for (const std::string& fault : broken) std::printf("  %s\n", fault.c_str());
  return broken.empty() ? 0 : 1;
}

}  // namespace
}  // namespace remesh::recognition

int main(int argc, char** argv) { return remesh::recognition::run_drawn({argv + 1, argv + argc}); }
