#include "server/http/site_rules.h"

namespace remesh::server {
namespace {

constexpr std::size_t kMaxShownName = 200;

HttpError misdirected(const Host& host) {
  const std::string name = host.name.substr(0, kMaxShownName);
  return HttpError(421, "misdirected_request",
                   "this server does not accept requests for the name " + name +
                       ", because a web page of another site could reach it under such a name; the operator of "
                       "this server can allow the name with --allowed-hosts " +
                       name);
}

HttpError cross_site(std::string_view origin) {
  const std::string known =
      origin.empty() || origin == "null" ? "ORIGIN" : std::string(origin.substr(0, kMaxShownName));
  return HttpError(403, "cross_site",
                   "pages of other sites may not use this server; the operator of this server can allow them "
                   "with --cors-origin " +
                       known +
                       ". If this is the server's own page behind a proxy, the proxy must pass on the Host "
                       "field, or --public-url must name the page's address");
}

/// True if pages of other sites may show or link to this: the request is for a file of the daemon's own page, as
/// images, scripts or the address bar send it. The page that caused such a request cannot read the answer.
bool is_plain_read(const RequestHead& head, Access access) {
  if (access != Access::kPageFile || (head.method != "GET" && head.method != "HEAD")) return false;
  const std::string mode = head.list("sec-fetch-mode");
  return mode.empty() || mode == "navigate" || mode == "no-cors";
}

}  // namespace

bool SiteRules::answers_to(const Host& host) const {
  switch (kind_of(host)) {
    case HostKind::kNone:
    case HostKind::kAddress:
    case HostKind::kLocalhost: return true;
    case HostKind::kDotless:
      if (!is_loopback_) return true;
      break;
    case HostKind::kMalformed: return false;
    case HostKind::kDomain: break;
  }
  return names_.allows(host.name) || (url_.origin() && url_.origin()->host.name == host.name);
}

bool SiteRules::is_own(const Origin& origin, const Host& host) const {
  if (is_at(origin, host)) return true;
  return url_.origin() && url_.origin()->scheme == origin.scheme && is_at(*url_.origin(), origin.host);
}

void SiteRules::check(const RequestHead& head, Access access) const {
  const Host host = parse_host(head.authority());
  if (access != Access::kProbe && kind_of(host) == HostKind::kMalformed)
    throw HttpError(400, "malformed_request", "the Host field names no host, with or without a port");
  if (access != Access::kProbe && !answers_to(host)) throw misdirected(host);

  // A field that is sent twice, which no browser does, becomes a list and matches nothing below.
  const std::string origin = head.list("origin");
  if (!origin.empty() && cors_.allows(origin)) return;
  const std::string site = head.list("sec-fetch-site");
  if (!site.empty()) {
    if (site == "same-origin" || site == "none" || is_plain_read(head, access)) return;
    throw cross_site(origin);
  }
  if (!head.has("origin")) return;
  const std::optional<Origin> named = parse_origin(origin);
  if (!named || !is_own(*named, host)) throw cross_site(origin);
}

}  // namespace remesh::server
