/// Keeps web pages of other sites from using a daemon that requires no API key. Any page that a user of this machine or
/// network opens can send requests to the daemon. If a key is required, such a page cannot use the daemon, because it
/// does not know the key.
#pragma once

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

  /// Refuses requests that a page of another site may have sent.
  /// Input:  `access` - of the route at the request's path.
  /// Errors: HttpError 421 - the request names a host that could be another site's: the owner of a domain name can
  ///         point it to this machine, and then a browser treats the owner's pages as this daemon's own (DNS
  ///         rebinding). HttpError 403 - a browser says that the request comes from a page of another site.
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
