/// Keeps web pages of other sites from using a daemon that asks for no API key. Any page that a user of this machine or
/// network looks at can send requests to the daemon. With a key it cannot, because it does not know the key.
#pragma once

#include <optional>
#include <string>

#include "server/http/allowed_hosts.h"
#include "server/http/cors.h"
#include "server/http/http_message.h"
#include "server/http/public_url.h"
#include "server/http/route.h"

namespace remesh::server {

class SiteRules {
 public:
  /// Input: `is_loopback` - the daemon listens on loopback only.
  SiteRules(AllowedHosts names, PublicUrl url, Cors cors, bool is_loopback)
      : names_(std::move(names)), url_(std::move(url)), cors_(std::move(cors)), is_loopback_(is_loopback) {}

  /// Refuses what a page of another site may have sent.
  /// Input:  `access` - of the route at the request's path.
  /// Errors: HttpError 421 - the request names a host that could be another site's: the owner of a name can let it
  ///         lead to this machine, and his pages then count as this daemon's own in a browser (DNS rebinding).
  ///         HttpError 403 - a browser says that the request comes from a page of another site.
  void check(const RequestHead& head, Access access) const;

 private:
  bool answers_to(const Host& host) const;
  bool is_own(const Origin& origin, const Host& host) const;

  AllowedHosts names_;
  PublicUrl url_;
  Cors cors_;
  bool is_loopback_;
};

}  // namespace remesh::server
