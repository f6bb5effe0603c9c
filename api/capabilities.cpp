// Answers GET /v1/capabilities and GET /openapi.json.
#include <algorithm>
#include <iterator>

#include "api/json_writer.h"
#include "api/negotiation.h"
#include "api/operations.h"
#include "api/options.h"
#include "api/report_json.h"
#include "core/base/coordinate_range.h"
#include "core/io/format_spec.h"
#include "core/remesh.h"

namespace remesh::api {

/// The build generates this text from openapi.yaml.
extern const char* const kOpenapiJson;

namespace {

std::string_view type_name(OptionType type) {
  switch (type) {
    case OptionType::kBoolean: return "boolean";
    case OptionType::kNumber: return "number";
    case OptionType::kInteger: return "integer";
    case OptionType::kWords:
    case OptionType::kAxis:
    case OptionType::kNames:
    case OptionType::kChoice: return "string";
  }
  return "string";
}

void write_option(JsonWriter& json, const OptionSpec& spec) {
  json.member("name", spec.name);
  json.member("type", type_name(spec.type));
  json.member("group", group_name(spec.group));
  json.key("default");
  write_option_value(json, option_value(spec, with_defaults(RequestOptions{})));
  if (!spec.unset.empty()) json.member("unset", spec.unset);
  if (const NumberRange* range = number_range(spec.name)) {
    json.member(range->above_minimum ? "exclusive_minimum" : "minimum", range->minimum);
    if (range->maximum) json.member("maximum", *range->maximum);
  }
  if (const std::vector<std::string_view> words = option_words(spec); !words.empty()) {
    json.values("values", words);
    if (spec.type == OptionType::kWords) json.member("is_list", true);
  }
  if (!spec.excludes.empty()) json.member("excludes", spec.excludes);
  json.member("description", spec.help);
}

std::string_view labels_name(LabelsHeld labels) {
  switch (labels) {
    case LabelsHeld::kNone: return "none";
    case LabelsHeld::kOne: return "one";
    case LabelsHeld::kAll: return "all";
  }
  return "none";
}

void write_formats(JsonWriter& json, std::string_view name, bool (*is_known)(Format),
                   std::string_view FormatSpec::*about) {
  std::vector<Format> formats;
  std::copy_if(kFormats.begin(), kFormats.end(), std::back_inserter(formats), is_known);
  json.objects(name, formats, [&](Format format) {
    const FormatSpec& spec = format_spec(format);
    json.member("name", format_name(format));
    json.member("media_type", media_type(format));
    json.member("ending", file_ending(format));
    json.values("endings", spec.endings);
    if (text_form(format) != format) json.member("text_form", format_name(text_form(format)));
    json.member("about", spec.*about);
    json.member("numbers", spec.storage == Storage::kFloat ? "float" : "double");
    json.member("labels", labels_name(spec.labels));
    write_programs(json, "programs", format, {});
  });
}

void write_limits(JsonWriter& json, const Limits& limits) {
  json.member("max_body", limits.max_body);
  json.member("max_decompressed", limits.decompression.max_bytes);
  json.member("max_ratio", limits.decompression.max_ratio);
  json.member("max_vertices", limits.input.max_vertices);
  json.member("max_faces", limits.input.max_faces);
  json.member("max_output_faces", limits.max_output_faces);
  json.member("workers", static_cast<std::uint64_t>(limits.workers));
  json.member("request_timeout_s", std::chrono::duration<double>(limits.request_timeout).count());
  json.member("max_queued_large", static_cast<std::uint64_t>(limits.queue.max_large));
  json.member("max_queued_small_bytes", limits.queue.max_small_bytes);
  json.member("max_queued_small_wait_s", std::chrono::duration<double>(limits.queue.max_small_wait).count());
  json.member("max_distance_from_middle", CoordinateRange::kFarthest);
  json.member("min_extent", CoordinateRange::kSmallest);
  json.member("min_width_of_length", CoordinateRange::kNarrowest);
}

Response json_response(std::string body) {
  Response response;
  response.content_type = media_type(Format::kJson);
  response.body = std::move(body);
  return response;
}

}  // namespace

Response capabilities(const Limits& limits) {
  JsonWriter json;
  json.object([&] {
    json.member("name", "remeshd");
    json.object("versions", [&] {
      json.member("remeshd", version());
      json.member("api", "v1");
    });
    json.object("formats", [&] {
      write_formats(json, "input", can_read, &FormatSpec::reads);
      write_formats(json, "output", is_written, &FormatSpec::about);
    });
    json.objects("options", option_table(), [&](const OptionSpec& spec) { write_option(json, spec); });
    json.object("limits", [&] { write_limits(json, limits); });
  });
  return json_response(json.take());
}

Response openapi() { return json_response(kOpenapiJson); }

}  // namespace remesh::api
