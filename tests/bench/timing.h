/// The way in which benchmarks take times: there are several runs, and the median counts.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace remesh::bench {

inline constexpr int kRuns = 3;

template <class Work>
double milliseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

inline double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

struct NamedWork {
  std::string name;
  std::function<void()> run;
};

/// Returns the median time of each work, in their order. The works take turns, so that changes in the speed of the
/// machine affect all alike.
inline std::vector<double> median_milliseconds(const std::vector<NamedWork>& works) {
  std::vector<std::vector<double>> times(works.size());
  for (int run = 0; run < kRuns; ++run)
    for (std::size_t w = 0; w < works.size(); ++w) times[w].push_back(milliseconds(works[w].run));
  std::vector<double> medians;
  for (std::vector<double>& t : times) medians.push_back(median(std::move(t)));
  return medians;
}

}  // namespace remesh::bench
