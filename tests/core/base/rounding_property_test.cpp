// Compares the estimate of what coordinates are rounded to with how random meshes were really rounded.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <numbers>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/tolerance.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

const std::uint64_t kSeed = base_seed(20360);

/// Returns how many meshes are tried. The environment variable REMESH_TRIALS replaces the usual number.
/// 100000 meshes take some minutes.
int trials() {
  constexpr int kUsual = 3000;
  const char* text = std::getenv("REMESH_TRIALS");
  return text != nullptr ? std::atoi(text) : kUsual;
}

enum class Kind { kDecimals, kDigits, kFloats, kNone };
constexpr std::array kKinds{Kind::kDecimals, Kind::kDigits, Kind::kFloats, Kind::kNone};

/// A way to round numbers.
struct Rounder {
  Kind kind = Kind::kNone;
  int places = 0;

  /// As printed: what is left of x, and the exponent of its first digit.
  double operator()(double x) const {
    if (kind == Kind::kNone) return x;
    if (kind == Kind::kFloats) return static_cast<double>(static_cast<float>(x));
    return printed(x).first;
  }
  /// Returns the number as it is printed, and whether it shows more than half of its significant digits.
  std::pair<double, bool> printed(double x) const {
    std::array<char, 400> text{};
    const bool is_fixed = kind == Kind::kDecimals;
    const auto format = is_fixed ? std::chars_format::fixed : std::chars_format::scientific;
    const auto [end, error] =
        std::to_chars(text.data(), text.data() + text.size(), x, format, is_fixed ? places : places - 1);
    EXPECT_EQ(error, std::errc());
    double value = 0;
    std::from_chars(text.data(), end, value);
    if (is_fixed) return {value, true};
    const std::string_view all(text.data(), static_cast<std::size_t>(end - text.data()));
    const std::string_view mantissa = all.substr(0, all.find('e'));
    const auto last = mantissa.find_last_of("123456789");
    if (last == std::string_view::npos) return {value, false};
    const auto shown = std::count_if(mantissa.begin(), mantissa.begin() + static_cast<std::ptrdiff_t>(last) + 1,
                                     [](char c) { return c >= '0' && c <= '9'; });
    return {value, 2 * shown > places || places == 1};
  }
  std::string name() const {
    switch (kind) {
      case Kind::kDecimals: return std::to_string(places) + " decimals";
      case Kind::kDigits: return std::to_string(places) + " digits";
      case Kind::kFloats: return "floats";
      case Kind::kNone: return "not rounded";
    }
    return "";
  }
};

double last_place(double x, int bits) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return x == 0 ? 0 : std::ldexp(1.0, exponent - bits);
}

/// The points of a mesh before they are rounded, and what is known about their coordinates.
struct WrittenModel {
  std::vector<Vec3> points;
  std::string name;
  std::vector<bool> is_free;                       ///< per coordinate: it may have any value, and depends on no other
  std::array<bool, 3> is_exact{true, true, true};  ///< per axis: no rounding changes anything there, nor shows
};

class Models {
 public:
  explicit Models(std::uint64_t seed) : random_(seed) {}

  WrittenModel any(double size) {
    const int n = count();
    WrittenModel model;
    switch (random_.below(5)) {
      case 0:
        model.name = "cloud";
        for (int i = 0; i < n; ++i) add_free(model, size);
        break;
      case 1: {
        // Plates between exact heights, with free corners.
        model.name = "plates";
        model.is_exact = {false, false, true};
        for (int i = 0; i < n; ++i) add(model, {free(size), free(size), exact(size)}, true, true, false);
        break;
      }
      case 2: {
        model.name = "cylinders";
        model.is_exact = {false, false, true};
        for (int left = n; left > 0;) {
          const int sides = random_.integer(3, 64);
          const double x = exact(size), y = exact(size), radius = size * random_.uniform(0.01, 0.25), low = exact(size),
                       high = exact(size);
          for (int i = 0; i < sides; ++i, left -= 2) {
            const double angle = 2 * std::numbers::pi * i / sides;
            for (const double z : {low, high})
              add(model, {x + radius * std::cos(angle), y + radius * std::sin(angle), z}, false, false, false);
          }
        }
        break;
      }
      case 3: {
        // Nearly all coordinates are exact.
        model.name = "grid with free corners";
        const int free_ones = random_.integer(1, 12);
        for (int i = 0; i < n; ++i) add(model, {exact(size), exact(size), exact(size)}, false, false, false);
        for (int i = 0; i < free_ones; ++i) add_free(model, size);
        break;
      }
      default: {
        model.name = "turned box";
        model.is_exact = {};
        const Vec3 o{free(size), free(size), free(size)};
        const std::array edges{Vec3{free(size), free(size), free(size)}, Vec3{free(size), free(size), free(size)},
                               Vec3{free(size), free(size), free(size)}};
        for (int i = 0; i < 8; ++i)
          add(model, o + (i & 1) * edges[0] + (i / 2 & 1) * edges[1] + (i / 4) * edges[2], false, false, false);
      }
    }
    if (random_.chance(0.3)) {
      model.name += ", moved";
      const Vec3 by{exact(100 * size), exact(100 * size), exact(100 * size)};
      for (Vec3& p : model.points) p = p + by;
    }
    return model;
  }

  Random& random() { return random_; }

 private:
  /// Few in most cases: there a claim may go wrong.
  int count() {
    const double most = random_.chance(0.03) ? 1e5 : 300;
    return static_cast<int>(4 * std::pow(most / 4, random_.unit()));
  }
  double free(double size) { return random_.uniform(-size, size); }
  /// Returns a multiple of a simple part of the size.
  double exact(double size) {
    const double unit = std::pow(10.0, std::round(std::log10(size)) - 2);
    static constexpr std::array kParts{1.0, 2.0, 5.0, 10.0, 25.0};
    const double part = unit * kParts[static_cast<std::size_t>(random_.below(static_cast<int>(kParts.size())))];
    return part * std::round(random_.uniform(-size, size) / part);
  }
  void add_free(WrittenModel& model, double size) {
    add(model, {free(size), free(size), free(size)}, true, true, true);
    model.is_exact = {};
  }
  void add(WrittenModel& model, const Vec3& p, bool x, bool y, bool z) {
    model.points.push_back(p);
    for (const bool is : {x, y, z}) model.is_free.push_back(is);
  }

  Random random_;
};

struct Truth {
  Vec3 steps;
  Vec3 as_floats, as_doubles;  ///< what is told of numbers that are not rounded
  int independent = 0;
};

/// Returns the coarsest rounding that gives the same points as `rounder` does. If there are few numbers, all may end in
/// a 0 by chance, and then they are those of a mesh that was rounded more coarsely.
Rounder coarsest_alike(const WrittenModel& model, Rounder rounder) {
  if (rounder.kind != Kind::kDecimals && rounder.kind != Kind::kDigits) return rounder;
  const int least = rounder.kind == Kind::kDecimals ? 0 : 1;
  for (; rounder.places > least; --rounder.places) {
    const Rounder coarser{rounder.kind, rounder.places - 1};
    const bool are_alike = std::all_of(model.points.begin(), model.points.end(), [&](const Vec3& p) {
      return rounder(p.x) == coarser(p.x) && rounder(p.y) == coarser(p.y) && rounder(p.z) == coarser(p.z);
    });
    if (!are_alike) break;
  }
  return rounder;
}

/// Rounds the points and says what a perfect estimate would be.
Truth round_to(WrittenModel& model, const Rounder& as_drawn) {
  const Rounder rounder = coarsest_alike(model, as_drawn);
  Truth truth;
  Vec3 largest, largest_long;
  std::vector<double> independent;
  bool are_floats = true;
  Box3 box;
  for (const Vec3& p : model.points) box.add(p);
  const double negligible = 1e-9 * box.diagonal();
  for (std::size_t i = 0; i < model.points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      double& x = model.points[i][axis];
      const bool is_long = rounder.kind != Kind::kDigits || rounder.printed(x).second;
      x = rounder(x);
      const double size = std::fabs(x);
      if (size <= negligible) continue;
      largest[axis] = std::max(largest[axis], size);
      if (is_long) largest_long[axis] = std::max(largest_long[axis], size);
      if (model.is_free[3 * i + static_cast<std::size_t>(axis)]) independent.push_back(size);
      are_floats = are_floats && static_cast<double>(static_cast<float>(x)) == x;
    }
  const double of_all = std::max({largest.x, largest.y, largest.z});
  std::sort(independent.begin(), independent.end());
  truth.independent = static_cast<int>(std::unique(independent.begin(), independent.end()) - independent.begin());
  for (int axis = 0; axis < 3; ++axis) {
    const double size = largest_long[axis] > 0 ? largest_long[axis] : largest[axis];
    double& step = truth.steps[axis];
    truth.as_doubles[axis] = last_place(of_all, 53);
    truth.as_floats[axis] = are_floats ? last_place(largest[axis], 24) : truth.as_doubles[axis];
    switch (rounder.kind) {
      case Kind::kDecimals: step = std::pow(10, -rounder.places); break;
      case Kind::kDigits: {
        const double exponent = size > 0 ? std::floor(std::log10(size * (1 + 1e-14))) : 0;
        step = size > 0 ? std::pow(10, exponent - rounder.places + 1) : 0;
        break;
      }
      case Kind::kFloats: step = truth.as_floats[axis]; break;
      case Kind::kNone: step = truth.as_doubles[axis]; break;
    }
    step = std::max(step, truth.as_floats[axis]);
  }
  return truth;
}

bool are_multiples(const std::vector<Vec3>& points, int axis, double step) {
  return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    const double units = p[axis] / step;
    return std::fabs(units - std::round(units)) <= 1e-14 * std::max(1.0, std::fabs(units));
  });
}

TEST(rounding_estimate, the_step_is_right_or_not_told_and_never_coarser_than_the_truth) {
  struct Count {
    int rounded = 0, found = 0;
  };
  std::array<Count, 4> counts{};
  const int n = trials();
  int told = 0, faults = 0, unlikely = 0;
  for (int trial = 0; trial < n && faults < 20; ++trial) {
    Models models(kSeed + static_cast<std::uint64_t>(trial) * 1'000'003);
    Random& random = models.random();
    const double size = std::pow(10, random.uniform(-3, 4));
    Rounder rounder{kKinds[static_cast<std::size_t>(random.below(4))], 0};
    // Steps are from as coarse as a tenth of the size to as fine as doubles have room for.
    if (rounder.kind == Kind::kDecimals)
      rounder.places = std::max(0, random.integer(1, 10) - static_cast<int>(std::floor(std::log10(size))));
    if (rounder.kind == Kind::kDigits) rounder.places = random.integer(1, 9);
    WrittenModel model = models.any(size);
    const Truth truth = round_to(model, rounder);
    const int power = random.chance(0.5) ? 0 : random.integer(-40, 40);
    const double scale = std::ldexp(1.0, power);
    for (Vec3& p : model.points) p = scale * p;
    RunControl control;
    const Rounding rounding = rounding_of(model.points, control);
    const double coarsest = std::max({truth.steps.x, truth.steps.y, truth.steps.z});
    if (trial % 8 == 0) {
      // As formats list vertices: once for each face, and in another order.
      std::vector<Vec3> listed(model.points.rbegin(), model.points.rend());
      for (std::size_t i = 0; i < model.points.size(); i += 2) listed.push_back(model.points[i]);
      const Rounding of_listed = rounding_of(listed, control);
      EXPECT_EQ(of_listed.steps, rounding.steps);
      EXPECT_EQ(of_listed.likely_steps, rounding.likely_steps);
      EXPECT_EQ(of_listed.possible_steps, rounding.possible_steps);
    }
    const Vec3 steps = (1 / scale) * rounding.steps, likely = (1 / scale) * rounding.likely_steps;
    bool is_right = true, is_not_told = true, is_finer = true, is_likely_finer = true;
    for (int axis = 0; axis < 3; ++axis) {
      // Exact numbers look the same in any step of which they are multiples: that of another axis is as true as theirs.
      const bool is_exact = model.is_exact[static_cast<std::size_t>(axis)];
      is_finer = is_finer && (steps[axis] <= (is_exact ? coarsest : truth.steps[axis]) * (1 + 1e-9) ||
                              (is_exact && are_multiples(model.points, axis, scale * steps[axis])));
      is_likely_finer = is_likely_finer && likely[axis] <= coarsest * (1 + 1e-9);
      if (is_exact) continue;
      const auto is = [&](double step) { return std::fabs(steps[axis] - step) <= 1e-9 * step; };
      is_right = is_right && is(truth.steps[axis]);
      is_not_told = is_not_told && (is(truth.as_floats[axis]) || is(truth.as_doubles[axis]));
    }
    const auto description = [&] {
      return "trial " + std::to_string(trial) + ": " + model.name + " of " + std::to_string(model.points.size()) +
             " vertices, size " + std::to_string(size) + ", " + rounder.name() + ", times 2^" + std::to_string(power) +
             ": steps " + std::to_string(steps.x / truth.steps.x) + " " + std::to_string(steps.y / truth.steps.y) +
             " " + std::to_string(steps.z / truth.steps.z) + ", likely " + std::to_string(likely.x / truth.steps.x) +
             " " + std::to_string(likely.y / truth.steps.y) + " " + std::to_string(likely.z / truth.steps.z) +
             " times the truth, independent " + std::to_string(truth.independent);
    };
    const bool holds = is_finer && (is_right || is_not_told);
    EXPECT_TRUE(holds) << description();
    faults += !holds;
    told += is_right;
    unlikely += !is_likely_finer;
    if (!is_likely_finer && std::getenv("REMESH_VERBOSE")) std::cout << "unlikely: " << description() << '\n';
    if (truth.independent > 30) {
      Count& count = counts[static_cast<std::size_t>(rounder.kind)];
      ++count.rounded;
      count.found += is_right;
      if (!is_right && std::getenv("REMESH_VERBOSE")) std::cout << description() << '\n';
    }
  }
  Count all;
  for (const Kind kind : {Kind::kDecimals, Kind::kDigits, Kind::kFloats}) {
    const Count& count = counts[static_cast<std::size_t>(kind)];
    std::cout << Rounder{kind, 0}.name() << ": " << count.found << " of " << count.rounded << " found\n";
    all.rounded += count.rounded;
    all.found += count.found;
  }
  EXPECT_GE(all.found, 0.99 * all.rounded);
  EXPECT_GT(told, n / 4);
  // One in 4096, and three of a Poisson distribution's deviations more.
  const double expected = n / 4096.0;
  std::cout << unlikely << " of " << n << " likely steps are too coarse\n";
  EXPECT_LE(unlikely, expected + 3 * std::sqrt(expected) + 1);
}

}  // namespace
}  // namespace remesh
