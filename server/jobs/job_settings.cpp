#include "server/jobs/job_settings.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace remesh::server::jobs {
namespace {

/// Makes the folder where it is missing, for nobody else to look into.
bool can_be_made(const std::string& folder) {
  std::error_code failure;
  if (std::filesystem::create_directories(folder, failure))
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all, failure);
  return std::filesystem::is_directory(folder, failure) && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

}  // namespace

std::string find_state_dir(const std::string& state_dir) {
  if (state_dir != "auto") {
    if (!can_be_made(state_dir)) throw std::invalid_argument("the folder " + state_dir + " cannot be written");
    return state_dir;
  }
  std::vector<std::string> folders;
  if (const char* systemd = std::getenv("STATE_DIRECTORY")) folders.emplace_back(systemd);
  if (const char* xdg = std::getenv("XDG_STATE_HOME")) folders.push_back(std::string(xdg) + "/remeshd");
  if (const char* home = std::getenv("HOME")) folders.push_back(std::string(home) + "/.local/state/remeshd");
  folders.emplace_back("/var/lib/remeshd");
  for (const std::string& folder : folders) {
    if (folder.front() == '/' && can_be_made(folder)) return folder;
  }
  return {};
}

std::string without_password(const std::string& store) {
  const std::size_t scheme = store.find("://");
  if (scheme == std::string::npos) return store;
  const std::size_t at = store.find('@', scheme);
  const std::size_t colon = store.find(':', scheme + 3);
  if (at == std::string::npos || colon == std::string::npos || colon > at) return store;
  return store.substr(0, colon + 1) + "***" + store.substr(at);
}

}  // namespace remesh::server::jobs
