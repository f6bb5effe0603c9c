#include "core/io/common/boundaries.h"

#include <algorithm>

#include "core/base/stoppable.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"

namespace remesh {
namespace {

bool is_portable_character(char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-' || c == '.'; }

/// Replaces what is not portable in a name. The result need not be the only one.
std::string with_portable_characters(std::string_view name) {
  std::string clean;
  while (!name.empty() && clean.size() < PortableNames::kMaxLength) {
    clean += is_portable_character(name.front()) ? name.front() : '_';
    name.remove_prefix(std::max<std::size_t>(utf8_length(name), 1));
  }
  return clean.empty() ? "unnamed" : clean;
}

}  // namespace

bool PortableNames::is_portable(std::string_view name) {
  return !name.empty() && name.size() <= kMaxLength && std::all_of(name.begin(), name.end(), is_portable_character);
}

std::string PortableNames::make(std::string_view name) {
  constexpr std::size_t kRoomForNumber = 21;  // a `_` and 64 bits
  std::string made = with_portable_characters(name);
  if (take(made)) return made;
  const std::string stem = made.substr(0, kMaxLength - kRoomForNumber);
  std::uint64_t& number = last_number_.try_emplace(stem, 1).first->second;
  do {
    made = stem + "_" + std::to_string(++number);
  } while (!take(made));
  return made;
}

const LabelSet* chosen_labels(const FaceLabels& labels, LabelChoice choice) {
  const auto used = [](const LabelSet& set) { return set.is_used() ? &set : nullptr; };
  switch (choice) {
    case LabelChoice::kObject: return used(labels.object);
    case LabelChoice::kGroup: return used(labels.group);
    case LabelChoice::kMaterial: return used(labels.material);
    case LabelChoice::kPatch:
    case LabelChoice::kSurface: return nullptr;
    case LabelChoice::kAuto: break;
  }
  for (const LabelSet* set : {&labels.group, &labels.object, &labels.material})
    if (set->is_used()) return set;
  return nullptr;
}

Boundaries::Boundaries(const WriterInput& input, RunControl& control, std::string (*exact_name)(std::string_view))
    : choice_(input.writing.label), input_(input), set_(chosen_labels(input.mesh.labels, choice_)) {
  const bool are_surfaces = choice_ == LabelChoice::kSurface && !input.surface_of_patch.empty();
  if (set_ == nullptr && !are_surfaces) choice_ = LabelChoice::kPatch;
  StopCheck check(control);
  if (set_ != nullptr) is_used_.resize(set_->names.size());
  for (std::size_t f = 0; f < input.mesh.faces.size(); ++f) {
    check();
    const std::uint32_t boundary = of(FaceId(f));
    if (boundary >= is_used_.size()) is_used_.resize(boundary + std::size_t{1});
    is_used_[boundary] = 1;
  }
  if (set_ == nullptr) return;

  names_.resize(size());
  const bool is_exact = input.writing.names == NameRule::kExact;
  // Names that need no change come first, so that no changed name takes one of them away.
  for (std::size_t i = 0; i < size(); ++i) {
    check();
    if (!has_faces(i)) continue;
    const std::string& name = set_->names[i];
    if (is_exact) {
      names_[i] = exact_name(name);
      names_taken_.take(names_[i]);
    } else if (PortableNames::is_portable(name) && names_taken_.take(name)) {
      names_[i] = name;
    }
  }
  for (std::size_t i = 0; i < size(); ++i) {
    check();
    if (!has_faces(i)) continue;
    if (!is_exact && names_[i].empty()) names_[i] = names_taken_.make(set_->names[i]);
    if (names_[i] != set_->names[i]) renamed_.push_back({set_->names[i], names_[i]});
  }
}

std::string Boundaries::name(std::size_t boundary) const {
  if (set_ != nullptr) return names_[boundary];
  return (choice_ == LabelChoice::kPatch ? "patch_" : "surface_") + std::to_string(boundary);
}

void append_names(std::string& out, std::string_view word, const Boundaries& boundaries, RunControl& control) {
  StopCheck check(control);
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    check();
    if (!boundaries.has_faces(i)) continue;
    out.append("# ").append(word).append(" ").append(std::to_string(i + 1)).append(": ");
    out.append(boundaries.name(i)).append("\n");
  }
}

Diagnostic renamed_diagnostic(const std::vector<RenamedLabel>& renamed) {
  Diagnostic diagnostic{DiagnosticCode::kRenamedLabels, renamed.size(), {}, ""};
  diagnostic.message =
      "names of labels that mesh programs would not read were changed: " + std::to_string(renamed.size()) +
      ", such as " + cited(renamed.front().from) + " to " + cited(renamed.front().to) +
      "; the report lists all of them; names=exact keeps them";
  return diagnostic;
}

}  // namespace remesh
