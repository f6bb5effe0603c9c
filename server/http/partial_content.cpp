#include "server/http/partial_content.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "api/quoting.h"
#include "server/http/header_lists.h"

namespace remesh::server {
namespace {

struct Range {
  std::uint64_t begin, end;  ///< the end is not included
};

std::optional<std::uint64_t> number(std::string_view digits) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

HttpError beyond(std::uint64_t size) {
  return HttpError(416, "range_not_satisfiable",
                   "the range begins beyond the end of the content, which is at byte " + std::to_string(size))
      .with_header("Content-Range", "bytes */" + std::to_string(size));
}

/// Output: nothing if the field is to be ignored, because it is malformed or asks for several ranges.
/// Errors: HttpError 416.
std::optional<Range> parse_range(std::string_view field, std::uint64_t size) {
  const auto [unit, set] = api::cut(field, '=');
  if (api::ascii_lower(trimmed(unit)) != "bytes" || set.find(',') != std::string_view::npos) return std::nullopt;
  const std::string_view spec = trimmed(set);
  const std::size_t dash = spec.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const std::string_view first = spec.substr(0, dash), last = spec.substr(dash + 1);
  if (first.empty()) {
    const std::optional<std::uint64_t> length = number(last);
    if (!length) return std::nullopt;
    if (*length == 0 || size == 0) throw beyond(size);
    return Range{size - std::min(size, *length), size};
  }
  const std::optional<std::uint64_t> begin = number(first);
  const std::optional<std::uint64_t> end = last.empty() ? std::optional(size) : number(last);
  if (!begin || !end || (!last.empty() && *end < *begin)) return std::nullopt;
  if (*begin >= size) throw beyond(size);
  return Range{*begin, *end < size ? *end + 1 : size};
}

/// True if an `If-Match` list names the tag, by strong comparison.
bool is_tag_in(std::string_view list, std::string_view tag) {
  const std::vector<std::string_view> elements = list_elements(list);
  return std::any_of(elements.begin(), elements.end(), [&](std::string_view e) { return e == "*" || e == tag; });
}

std::string_view value_of(const Fields& fields, std::string_view name) {
  const auto field = std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.first == name; });
  return field == fields.end() ? std::string_view() : std::string_view(field->second);
}

}  // namespace

bool names_tag(std::string_view list, std::string_view tag) {
  const auto opaque = [](std::string_view t) { return t.substr(t.starts_with("W/") ? 2 : 0); };
  for (const std::string_view element : list_elements(list)) {
    if (element == "*" || opaque(element) == opaque(tag)) return true;
  }
  return false;
}

Response with_ranges(Response answer, const RequestHead& request) {
  std::string body = std::exchange(answer.body, {});
  return with_ranges(std::move(answer), request, body.size(), [&](std::uint64_t begin, std::uint64_t end) {
    return begin == 0 && end == body.size() ? std::move(body) : body.substr(begin, end - begin);
  });
}

Response with_ranges(Response answer, const RequestHead& request, std::uint64_t size,
                     const std::function<std::string(std::uint64_t, std::uint64_t)>& read) {
  const auto complete = [&] {
    if (request.method == "HEAD")
      answer.size_for_head = size;
    else
      answer.body = read(0, size);
    return std::move(answer);
  };
  const std::string digest(value_of(answer.headers, "Repr-Digest"));
  if (answer.status != 200 || digest.empty()) return complete();
  // The digest covers the bytes as they are sent, so that another format or coding has another tag.
  const std::string tag = "\"" + digest.substr(digest.find(':') + 1, 22) + "\"";
  if (request.has("if-match") && !is_tag_in(request.list("if-match"), tag))
    throw HttpError(412, "precondition_failed", "the result has the tag " + tag + ", which If-Match does not name");
  answer.headers.emplace_back("ETag", tag);
  answer.headers.emplace_back("Accept-Ranges", "bytes");
  if (names_tag(request.list("if-none-match"), tag)) {
    answer.status = 304;
    answer.content_type.clear();
    return answer;
  }
  const std::string_view condition = request.header("if-range");
  if (!request.has("range") || request.method != "GET" || (!condition.empty() && condition != tag)) return complete();
  const std::optional<Range> range = parse_range(request.list("range"), size);
  if (!range) return complete();
  answer.status = 206;
  answer.headers.emplace_back("Content-Range", "bytes " + std::to_string(range->begin) + "-" +
                                                   std::to_string(range->end - 1) + "/" + std::to_string(size));
  answer.body = read(range->begin, range->end);
  return answer;
}

}  // namespace remesh::server
