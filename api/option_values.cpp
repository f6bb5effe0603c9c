#include "api/option_values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "api/quoting.h"
#include "core/base/number_text.h"

namespace remesh::api {
namespace {

template <class T>
using Word = std::pair<std::string_view, bool T::*>;

constexpr std::array<Word<Repair>, 9> kRepairWords{{{"duplicates", &Repair::duplicates},
                                                    {"degenerate", &Repair::degenerate},
                                                    {"t_junctions", &Repair::t_junctions},
                                                    {"winding", &Repair::winding},
                                                    {"seams", &Repair::seams},
                                                    {"inside_out", &Repair::inside_out},
                                                    {"holes", &Repair::holes},
                                                    {"self_intersections", &Repair::self_intersections},
                                                    {"union", &Repair::make_union}}};
constexpr std::array<Word<Barriers>, 3> kBarrierWords{
    {{"object", &Barriers::object}, {"group", &Barriers::group}, {"material", &Barriers::material}}};

constexpr std::array<std::pair<std::string_view, Preset>, 2> kPresetWords{
    {{"volume", Preset::kVolume}, {"exact", Preset::kExact}}};

/// The words for the values of an enumeration.
template <class Value>
struct Choice;
template <>
struct Choice<CircleFit> {
  static constexpr std::array<std::pair<std::string_view, CircleFit>, 2> kWords{
      {{"inscribed", CircleFit::kInscribed}, {"volume", CircleFit::kVolume}}};
};
template <>
struct Choice<LabelChoice> {
  static constexpr std::array<std::pair<std::string_view, LabelChoice>, 6> kWords{{{"auto", LabelChoice::kAuto},
                                                                                   {"object", LabelChoice::kObject},
                                                                                   {"group", LabelChoice::kGroup},
                                                                                   {"material", LabelChoice::kMaterial},
                                                                                   {"patch", LabelChoice::kPatch},
                                                                                   {"surface", LabelChoice::kSurface}}};
};
template <>
struct Choice<NameRule> {
  static constexpr std::array<std::pair<std::string_view, NameRule>, 2> kWords{
      {{"portable", NameRule::kPortable}, {"exact", NameRule::kExact}}};
};
template <>
struct Choice<StlSolids> {
  static constexpr std::array<std::pair<std::string_view, StlSolids>, 2> kWords{
      {{"label", StlSolids::kLabel}, {"one", StlSolids::kOne}}};
};
template <>
struct Choice<MshVersion> {
  static constexpr std::array<std::pair<std::string_view, MshVersion>, 2> kWords{
      {{"2.2", MshVersion::k22}, {"4.1", MshVersion::k41}}};
};

template <>
struct Choice<GlbColours> {
  static constexpr std::array<std::pair<std::string_view, GlbColours>, 2> kWords{
      {{"label", GlbColours::kLabel}, {"quality", GlbColours::kQuality}}};
};

/// The type of the member that a pointer points to, if an option's value may be only one of several words.
template <class Field>
struct ChoiceMember;
template <class Value, class Of>
struct ChoiceMember<Value Of::*> {
  using Type = Value;
};
template <class Field>
concept IsChoice = requires {
  Choice<typename ChoiceMember<Field>::Type>::kWords;
};

template <class Value>
auto& member_of(auto& options, Value Options::*field) {
  return options.core.*field;
}
template <class Value>
auto& member_of(auto& options, Value Writing::*field) {
  return options.writing.*field;
}

std::string describe_words(const OptionSpec& spec) {
  std::string text;
  for (const std::string_view word : option_words(spec)) text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

[[noreturn]] void fail_value(const OptionSpec& spec, std::string_view text) {
  std::string expected;
  switch (spec.type) {
    case OptionType::kBoolean: expected = "true or false"; break;
    case OptionType::kNumber: expected = "a number " + number_range(spec.name)->text(); break;
    case OptionType::kInteger: expected = "a whole number " + number_range(spec.name)->text(); break;
    case OptionType::kWords:
      expected = "none, or some of " + describe_words(spec) +
                 ", each once, separated by commas: all without a sign, or all as +word or -word";
      break;
    case OptionType::kAxis: expected = "x, dominant_edge, or three numbers dx,dy,dz that are not all 0"; break;
    case OptionType::kNames: expected = "none, or names separated by commas, each of 1 to 100 bytes"; break;
    case OptionType::kChoice:
      expected = (option_words(spec).size() == 1 ? "" : "one of ") + describe_words(spec);
      break;
  }
  if (spec.type == OptionType::kNumber)
    for (const std::string_view word : option_words(spec)) expected.append(", ").append(word);
  if (!spec.unset.empty()) expected += ", or " + std::string(spec.unset);
  throw invalid_option(spec, "must be " + expected + ", not " + in_quotes(text));
}

std::optional<double> parse_finite(std::string_view text) {
  const Real real = parse_real(text);
  return real.fault == RealFault::kNone ? std::optional(real.value) : std::nullopt;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// Reads a boolean as programming languages write it: `true`, `True`, `TRUE` or `1`.
bool parse_boolean(const OptionSpec& spec, std::string_view text) {
  const std::string word = ascii_lower(text);
  if (word == "true" || word == "1") return true;
  if (word != "false" && word != "0") fail_value(spec, text);
  return false;
}

void check_range(const OptionSpec& spec, double value, std::string_view text) {
  if (!number_range(spec.name)->contains(value)) fail_value(spec, text);
}

double parse_number(const OptionSpec& spec, std::string_view text) {
  const std::optional<double> value = parse_finite(text);
  if (!value) fail_value(spec, text);
  check_range(spec, *value, text);
  return *value;
}

/// Reads an integer. "1e6" and "1000.0" are accepted too: they are integers in JSON Schema and to callers who compute
/// in doubles.
std::uint64_t parse_integer(const OptionSpec& spec, std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    const std::optional<double> number = parse_finite(text);
    if (!number || !(*number >= 0 && *number <= 0x1p53) || *number != std::floor(*number)) fail_value(spec, text);
    value = static_cast<std::uint64_t>(*number);
  }
  check_range(spec, static_cast<double>(value), text);
  return value;
}

/// The sign in front of a word of a list. `application/x-www-form-urlencoded` decodes a plus to a blank, so a plus
/// that was typed in a URL may arrive as a blank.
enum class WordSign { kNone, kPlus, kMinus };

WordSign take_sign(std::string_view& word) {
  WordSign sign = WordSign::kNone;
  if (word.starts_with('+') || word.starts_with(' ')) sign = WordSign::kPlus;
  if (word.starts_with('-')) sign = WordSign::kMinus;
  if (sign != WordSign::kNone) word.remove_prefix(1);
  return sign;
}

/// Reads a list of words. Words without signs are the whole list; words with signs change the default.
template <class T, std::size_t N>
T parse_words(const OptionSpec& spec, const std::array<Word<T>, N>& words, std::string_view text) {
  T none, given;
  for (const auto& [name, member] : words) none.*member = given.*member = false;
  if (text == "none") return none;
  const std::vector<std::string_view> parts = split(text, ',');
  std::string_view first = parts.front();
  const bool are_changes = take_sign(first) != WordSign::kNone;
  T set = are_changes ? T{} : none;
  for (std::string_view part : parts) {
    const WordSign sign = take_sign(part);
    const auto word = std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.first == part; });
    if (word == words.end() || given.*(word->second)) fail_value(spec, text);
    if ((sign != WordSign::kNone) != are_changes)
      throw invalid_option(
          spec, "mixes words with a sign, which change the default, and words without a sign, which replace it: " +
                    in_quotes(text) + "; a blank before a word counts as a plus");
    given.*(word->second) = true;
    set.*(word->second) = sign != WordSign::kMinus;
  }
  return set;
}

template <class T, std::size_t N>
std::string words_text(const std::array<Word<T>, N>& words, const T& set) {
  std::string text;
  for (const auto& [name, member] : words) {
    if (set.*member) text.append(text.empty() ? "" : ",").append(name);
  }
  return text.empty() ? "none" : text;
}

/// The value of elements_per_circle with which facets stay.
constexpr std::string_view kNoElements = "none";

void parse_elements(const OptionSpec& spec, std::string_view text, Options& options) {
  const bool is_word = text == kNoElements || text == spec.unset;
  options.elements_per_circle = is_word ? std::nullopt : std::optional(parse_number(spec, text));
  options.coarsens_fine_facets = text != kNoElements;
}

void parse_axis(const OptionSpec& spec, std::string_view text, Options& options) {
  if (text == "x" || text == "dominant_edge") {
    options.reference_axis = text == "x" ? ReferenceAxis::kX : ReferenceAxis::kDominantEdge;
    return;
  }
  const std::vector<std::string_view> parts = split(text, ',');
  if (parts.size() != 3) fail_value(spec, text);
  Vec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = parse_finite(parts[static_cast<std::size_t>(axis)]);
    if (!value) fail_value(spec, text);
    direction[axis] = *value;
  }
  if (direction == Vec3{}) fail_value(spec, text);
  options.reference_axis = ReferenceAxis::kGiven;
  options.reference_direction = direction;
}

/// The word for no names.
constexpr std::string_view kNoNames = "none";

std::vector<std::string> parse_names(const OptionSpec& spec, std::string_view text) {
  constexpr std::size_t kMaxNames = 100, kMaxName = 100;
  std::vector<std::string> names;
  if (text == kNoNames) return names;
  for (const std::string_view name : split(text, ',')) {
    if (name.empty() || name.size() > kMaxName || names.size() == kMaxNames) fail_value(spec, text);
    names.emplace_back(name);
  }
  return names;
}

std::string names_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(text.empty() ? "" : ",").append(name);
  return text.empty() ? std::string(kNoNames) : text;
}

std::string axis_text(const Options& options) {
  switch (options.reference_axis) {
    case ReferenceAxis::kX: return "x";
    case ReferenceAxis::kDominantEdge: return "dominant_edge";
    case ReferenceAxis::kGiven: break;
  }
  const Vec3& d = options.reference_direction;
  return shortest_text(d.x) + "," + shortest_text(d.y) + "," + shortest_text(d.z);
}

/// Finds the value that a word stands for.
template <class Value, std::size_t N>
Value parse_choice(const OptionSpec& spec, const std::array<std::pair<std::string_view, Value>, N>& words,
                   std::string_view text) {
  const auto* word = std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.first == text; });
  if (word == words.end()) fail_value(spec, text);
  return word->second;
}

template <class Value, std::size_t N>
std::string_view choice_name(const std::array<std::pair<std::string_view, Value>, N>& words, Value value) {
  const auto* word = std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.second == value; });
  return word == words.end() ? std::string_view() : word->first;
}

Format parse_format(const OptionSpec& spec, std::string_view text) {
  const std::optional<Format> format = format_from_name(text);
  if (!format || !is_written(*format)) fail_value(spec, text);
  return *format;
}

bool is_word_of(const OptionSpec& spec, std::string_view text) {
  const std::vector<std::string_view> words = option_words(spec);
  return std::find(words.begin(), words.end(), text) != words.end();
}

// JSON has types, so a string is not accepted as a number. An option that may be unset accepts null or its word.
void check_kind(const OptionSpec& spec, std::string_view text, ValueKind kind) {
  bool fits = true;
  switch (kind) {
    case ValueKind::kUntyped: break;
    case ValueKind::kBoolean: fits = spec.type == OptionType::kBoolean; break;
    case ValueKind::kNumber:
      fits = spec.type == OptionType::kNumber || spec.type == OptionType::kInteger || is_word_of(spec, text);
      break;
    case ValueKind::kList:
      fits = spec.type == OptionType::kWords || spec.type == OptionType::kAxis || spec.type == OptionType::kNames;
      break;
    case ValueKind::kNull: fits = !spec.unset.empty(); break;
    case ValueKind::kObject: fits = false; break;
    case ValueKind::kString:
      fits = (!spec.unset.empty() && text == spec.unset) || spec.type == OptionType::kWords ||
             spec.type == OptionType::kAxis || spec.type == OptionType::kChoice || spec.type == OptionType::kNames ||
             is_word_of(spec, text);
      break;
  }
  if (!fits) fail_value(spec, kind == ValueKind::kNull ? "null" : text);
}

}  // namespace

Error invalid_option(const OptionSpec& spec, const std::string& message) {
  return Error(Code::kInvalidOption, Stage::kRead, std::string(spec.name) + " " + message)
      .for_option(std::string(spec.name));
}

void set_option(const OptionSpec& spec, std::string_view text, ValueKind kind, RequestOptions& options) {
  check_kind(spec, text, kind);
  if (kind == ValueKind::kNull) text = spec.unset;
  Options& core = options.core;
  std::visit(
      [&](auto field) {
        using F = decltype(field);
        if constexpr (std::is_same_v<F, bool Options::*>) {
          core.*field = parse_boolean(spec, text);
        } else if constexpr (std::is_same_v<F, double Options::*>) {
          core.*field = parse_number(spec, text);
        } else if constexpr (std::is_same_v<F, std::optional<double> Options::*>) {
          core.*field = text == spec.unset ? std::nullopt : std::optional(parse_number(spec, text));
        } else if constexpr (std::is_same_v<F, std::optional<std::uint64_t> Options::*>) {
          core.*field = text == spec.unset ? std::nullopt : std::optional(parse_integer(spec, text));
        } else if constexpr (std::is_same_v<F, Repair Options::*>) {
          core.*field = parse_words(spec, kRepairWords, text);
        } else if constexpr (std::is_same_v<F, Barriers Options::*>) {
          core.*field = parse_words(spec, kBarrierWords, text);
        } else if constexpr (IsChoice<F>) {
          member_of(options, field) = parse_choice(spec, Choice<typename ChoiceMember<F>::Type>::kWords, text);
        } else if constexpr (std::is_same_v<F, AxisField>) {
          parse_axis(spec, text, core);
        } else if constexpr (std::is_same_v<F, ElementsField>) {
          parse_elements(spec, text, core);
        } else if constexpr (std::is_same_v<F, PlyLabelsField>) {
          options.ply_labels = text == spec.unset ? std::nullopt : std::optional(parse_names(spec, text));
        } else if constexpr (std::is_same_v<F, PresetField>) {
          options.preset = text == spec.unset ? std::nullopt : std::optional(parse_choice(spec, kPresetWords, text));
        } else {
          options.format = text == spec.unset ? std::nullopt : std::optional(parse_format(spec, text));
        }
      },
      spec.field);
}

bool is_of_output(const OptionSpec& spec) {
  return std::visit(
      [&](auto field) {
        using F = decltype(field);
        if constexpr (std::is_same_v<F, bool Options::*>) return field == &Options::local_origin;
        if constexpr (IsChoice<F>) return !std::is_same_v<F, CircleFit Options::*>;
        return std::is_same_v<F, FormatField>;
      },
      spec.field);
}

std::vector<std::string_view> option_words(const OptionSpec& spec) {
  std::vector<std::string_view> words;
  if (std::holds_alternative<Repair Options::*>(spec.field)) {
    for (const auto& word : kRepairWords) words.push_back(word.first);
  } else if (std::holds_alternative<Barriers Options::*>(spec.field)) {
    for (const auto& word : kBarrierWords) words.push_back(word.first);
  } else if (std::holds_alternative<ElementsField>(spec.field)) {
    words.push_back(kNoElements);
  } else if (std::holds_alternative<PresetField>(spec.field)) {
    for (const auto& word : kPresetWords) words.push_back(word.first);
  } else if (std::holds_alternative<FormatField>(spec.field)) {
    for (const Format format : kFormats)
      if (is_written(format)) words.push_back(format_name(format));
  }
  std::visit(
      [&](auto field) {
        if constexpr (IsChoice<decltype(field)>)
          for (const auto& word : Choice<typename ChoiceMember<decltype(field)>::Type>::kWords)
            words.push_back(word.first);
      },
      spec.field);
  return words;
}

OptionValue option_value(const OptionSpec& spec, const RequestOptions& options) {
  const Options& core = options.core;
  return std::visit(
      [&](auto field) -> OptionValue {
        using F = decltype(field);
        if constexpr (std::is_same_v<F, bool Options::*> || std::is_same_v<F, double Options::*>) {
          return core.*field;
        } else if constexpr (std::is_same_v<F, std::optional<double> Options::*> ||
                             std::is_same_v<F, std::optional<std::uint64_t> Options::*>) {
          return core.*field ? OptionValue(*(core.*field)) : OptionValue();
        } else if constexpr (std::is_same_v<F, Repair Options::*>) {
          return words_text(kRepairWords, core.*field);
        } else if constexpr (std::is_same_v<F, Barriers Options::*>) {
          return words_text(kBarrierWords, core.*field);
        } else if constexpr (IsChoice<F>) {
          return std::string(choice_name(Choice<typename ChoiceMember<F>::Type>::kWords, member_of(options, field)));
        } else if constexpr (std::is_same_v<F, AxisField>) {
          return axis_text(core);
        } else if constexpr (std::is_same_v<F, ElementsField>) {
          if (core.elements_per_circle) return *core.elements_per_circle;
          return core.coarsens_fine_facets ? OptionValue() : OptionValue(std::string(kNoElements));
        } else if constexpr (std::is_same_v<F, PlyLabelsField>) {
          return options.ply_labels ? OptionValue(names_text(*options.ply_labels)) : OptionValue();
        } else if constexpr (std::is_same_v<F, PresetField>) {
          return options.preset ? OptionValue(std::string(choice_name(kPresetWords, *options.preset))) : OptionValue();
        } else {
          return options.format ? OptionValue(std::string(format_name(*options.format))) : OptionValue();
        }
      },
      spec.field);
}

std::string option_text(const OptionSpec& spec, const RequestOptions& options) {
  return std::visit(
      [&](const auto& value) -> std::string {
        using V = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<V, std::monostate>) {
          return std::string(spec.unset);
        } else if constexpr (std::is_same_v<V, bool>) {
          return value ? "true" : "false";
        } else if constexpr (std::is_same_v<V, std::string>) {
          return value;
        } else if constexpr (std::is_floating_point_v<V>) {
          return shortest_text(value);
        } else {
          return std::to_string(value);
        }
      },
      option_value(spec, options));
}

}  // namespace remesh::api
