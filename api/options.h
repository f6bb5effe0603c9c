/// The options of the API. Each is declared once, in `option_table`. Reading it from a query string, from JSON and
/// from the command line, /v1/capabilities and the report's `options` all follow from its row there. Only the range
/// of a number stands elsewhere, in the core's `number_options`.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/options.h"
#include "core/io/formats.h"

namespace remesh::api {

/// A name for values of several options.
enum class Preset {
  kVolume,  ///< settings for volume meshing: small edges at narrow gaps, and 16 edges per circle
  kExact,   ///< facets and boundaries stay as they are: feature_angle_deg=0, split_boundaries=false, defeature_size=0
};

/// All settings that a caller may choose: the options of the pipeline, with the preset already applied, and the form of
/// the answer.
struct RequestOptions {
  Options core;
  std::optional<Preset> preset;
  std::optional<Format> format;
  Writing writing = {};
  std::optional<std::vector<std::string>> ply_labels = {};  ///< see ReadLimits
};

enum class OptionType {
  kBoolean,
  kNumber,
  kInteger,
  kWords,   ///< words separated by commas, or `none`; if all have a + or - in front, they change the default
  kAxis,    ///< `x`, `dominant_edge` or `dx,dy,dz`
  kChoice,  ///< one word of several
  kNames,   ///< any names separated by commas, or `none`
};

/// The subject of an option. Help, documents and the page show the options in groups, in this order.
enum class OptionGroup {
  kResult,  ///< what comes out: presets, angles, the format
  kSize,    ///< how large triangles are, and how many
  kCurved,  ///< what becomes of curved surfaces
  kRepair,  ///< what is repaired, and which details are removed
  kExpert,  ///< what hardly anybody needs
};

/// Marks the option that does not belong to the pipeline: the format of the answer.
struct FormatField {};
/// Marks the option that stands for values of other options.
struct PresetField {};
/// Marks the option that sets both `reference_axis` and `reference_direction`.
struct AxisField {};
/// Marks the option that sets both `elements_per_circle` and `coarsens_fine_facets`.
struct ElementsField {};

/// Marks the option that concerns the reading of PLY.
struct PlyLabelsField {};

/// The member in which an option's value is stored.
using OptionField =
    std::variant<bool Options::*, double Options::*, std::optional<double> Options::*,
                 std::optional<std::uint64_t> Options::*, Repair Options::*, Barriers Options::*, CircleFit Options::*,
                 LabelChoice Writing::*, NameRule Writing::*, StlSolids Writing::*, MshVersion Writing::*,
                 GlbColours Writing::*, AxisField, ElementsField, PlyLabelsField, PresetField, FormatField>;

struct OptionSpec {
  std::string_view name;
  OptionType type;
  OptionField field;
  OptionGroup group = OptionGroup::kExpert;
  std::string_view help;           ///< one sentence, without its full stop
  std::string_view unset = {};     ///< the word for "no value" if the option may have none: `none`, `auto`
  std::string_view excludes = {};  ///< an option that may not be given together with this one
  std::string_view example = {};   ///< a value that is valid and not the default
};

/// All options by their groups, in the order of the API's documentation.
std::span<const OptionSpec> option_table();
/// The stable name of a group: `result`, `size`, ...
std::string_view group_name(OptionGroup group);
/// Finds an option by its name.
/// Output: null if there is none.
const OptionSpec* find_option(std::string_view name);
/// Finds the option that a wrong name most likely stands for: the one that other programs call so; else one of whose
/// name it is a part, or the other way round; else the one that takes the fewest edits. Case and separators do not
/// count. The first one wins a tie.
const OptionSpec& nearest_option(std::string_view name);
/// True if an option does not change the result, but only the form in which it is written.
bool is_of_output(const OptionSpec& spec);
/// The words that a kWords or kChoice option accepts, and those that an option accepts in place of a number,
/// without the word for "no value".
std::vector<std::string_view> option_words(const OptionSpec& spec);

/// A value in the form in which JSON shows it; monostate if none is set.
using OptionValue = std::variant<std::monostate, bool, double, std::uint64_t, std::string>;
OptionValue option_value(const OptionSpec& spec, const RequestOptions& options);
/// The value as text, in the form that a query string accepts.
std::string option_text(const OptionSpec& spec, const RequestOptions& options);
/// Replaces unset values by those that the pipeline will use: min_angle_deg if neither it nor max_radius_edge_ratio is
/// set, gradation if proximity is set, and `none` for elements_per_circle where `auto` does not act. The returned
/// options ask for the same result.
RequestOptions with_defaults(RequestOptions options);

/// The JSON type of an option's value before it became text. Query strings and flags are untyped.
enum class ValueKind { kUntyped, kBoolean, kNumber, kString, kList, kObject, kNull };

/// Collects the options of one request from all the places where they may occur.
class OptionReader {
 public:
  OptionReader() = default;
  /// `defaults` has the values of the options that are not given.
  explicit OptionReader(RequestOptions defaults) : options_(std::move(defaults)) {}

  /// Reads one option. The items of a list are separated by commas.
  /// Holds:  the order does not matter: a given option overrides the value that a preset has for it.
  /// Errors: kUnknownOption - the message names the nearest known one; kInvalidOption - given twice, of the wrong
  ///         type, not a number, out of range, or together with an option that excludes it. Each error has `option`
  ///         set.
  void add(std::string_view name, std::string_view text, ValueKind kind = ValueKind::kUntyped);

  /// Errors: kInvalidOption - the pipeline itself refuses the options (check_options).
  void check() const;

  const RequestOptions& options() const { return options_; }
  bool is_any_given() const { return !given_.empty(); }

 private:
  bool is_given(std::string_view name) const;
  /// Sets the values of the preset in all options that are not given.
  void apply_preset();

  RequestOptions options_;
  std::vector<std::string_view> given_;
};

}  // namespace remesh::api
