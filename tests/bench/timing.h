/// How benchmarks take times: several runs, the one in the middle.
#pragma once

#include <algorithm>
#include <chrono>
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

template <class Work>
double median_milliseconds(const Work& work) {
  std::vector<double> times;
  for (int run = 0; run < kRuns; ++run) times.push_back(milliseconds(work));
  return median(std::move(times));
}

}  // namespace remesh::bench
