/// The options of the contract. Each is declared once, in `option_table`; reading it from a query string, from JSON and
/// from the command line, /v1/capabilities and the report's `options` all follow from that row.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/options.h"
#include "core/io/formats.h"

namespace remesh::api {

/// What a caller may ask for: the pipeline's options and the format of the answer.
struct RequestOptions {
  Options core;
  std::optional<Format> format;
};

enum class OptionType {
  kBoolean,
  kNumber,
  kInteger,
  kWords,   ///< words from a list, separated by commas, or `none`; all as +word or -word: changes of the default
  kAxis,    ///< `x`, `dominant_edge` or `dx,dy,dz`
  kFormat,  ///< the name of a mesh format
};

/// Marks the one option that is not the pipeline's: the format of the answer.
struct FormatField {};
/// Marks the option that sets both `reference_axis` and `reference_direction`.
struct AxisField {};

/// Where an option's value is kept.
using OptionField = std::variant<bool Options::*, double Options::*, std::optional<double> Options::*,
                                 std::optional<std::uint64_t> Options::*, Repair Options::*, Barriers Options::*,
                                 AxisField, FormatField>;

struct OptionSpec {
  std::string_view name;
  OptionType type;
  OptionField field;
  std::string_view help;
  std::string_view unset = {};         ///< the word for "no value" where there may be none: `none`, `auto`
  std::optional<double> minimum = {};  ///< of numbers
  bool above_minimum = false;          ///< the minimum itself is excluded
  std::optional<double> maximum = {};
  std::string_view excludes = {};  ///< an option that may not be given as well
  std::string_view example = {};   ///< a value that is valid and not the default
};

/// All options, in the contract's order.
std::span<const OptionSpec> option_table();
/// The option of that name; null if there is none.
const OptionSpec* find_option(std::string_view name);
/// The option whose name takes the fewest edits to reach from `name`; the first of equals.
const OptionSpec& nearest_option(std::string_view name);
/// The words that a kWords or kFormat option knows; empty for others.
std::vector<std::string_view> option_words(const OptionSpec& spec);

/// A value as the contract's JSON shows it; monostate where none is set.
using OptionValue = std::variant<std::monostate, bool, double, std::uint64_t, std::string>;
OptionValue option_value(const OptionSpec& spec, const RequestOptions& options);
/// The same as text, as a query string takes it.
std::string option_text(const OptionSpec& spec, const RequestOptions& options);
/// The same options with the value that the pipeline takes for what was left open: min_angle_deg where neither it nor
/// max_radius_edge_ratio is set, gradation with proximity. Sent again, they ask for the same.
RequestOptions with_defaults(RequestOptions options);

/// What an option's text was before it was text. Query strings and flags know no types.
enum class ValueKind { kUntyped, kBoolean, kNumber, kString, kList, kObject, kNull };

/// Gathers the options of one request, from all the places where they may stand.
class OptionReader {
 public:
  /// Takes one option; a list has its items separated by commas.
  /// Errors: kUnknownOption - naming the nearest known one; kInvalidOption - given twice, of the wrong type, not a
  ///         number, out of range, or beside one that excludes it. All with `option`.
  void add(std::string_view name, std::string_view text, ValueKind kind = ValueKind::kUntyped);

  /// Errors: kInvalidOption - what the pipeline itself refuses (check_options).
  void check() const;

  const RequestOptions& options() const { return options_; }

 private:
  bool is_given(std::string_view name) const;

  RequestOptions options_;
  std::vector<std::string_view> given_;
};

}  // namespace remesh::api
