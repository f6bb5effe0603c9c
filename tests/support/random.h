/// Random numbers that are the same on every platform. They use the standard's engine, but not its distributions.
#pragma once

#include <cstdint>
#include <random>

namespace remesh {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// Returns a multiple of 2^-53 from [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  /// Returns a number from 0 to n - 1.
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  /// Returns a number from low to high, both included.
  int integer(int low, int high) { return low + below(high - low + 1); }
  bool chance(double probability) { return unit() < probability; }

 private:
  std::mt19937_64 engine_;
};

/// Returns the first seed of a property test and prints it. It is the value of the environment variable REMESH_SEED,
/// to try other seeds, or else `usual`.
std::uint64_t base_seed(std::uint64_t usual);

}  // namespace remesh
