#include "server/jobs/job_settings.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

namespace remesh::server::jobs {
namespace {

/// Creates the folder if it does not exist, readable by its owner only.
/// Output: true if the folder can be written.
bool can_be_made(const std::string& folder) {
  std::error_code failure;
  if (std::filesystem::create_directories(folder, failure))
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all, failure);
  return std::filesystem::is_directory(folder, failure) && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

/// True if `can_be_made` would succeed. It creates nothing.
bool could_be_made(std::filesystem::path folder) {
  std::error_code failure;
  while (!std::filesystem::exists(folder, failure) && folder.has_relative_path()) folder = folder.parent_path();
  if (folder.empty()) folder = ".";
  return std::filesystem::is_directory(folder, failure) && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

constexpr const char* kHidden = "***";

/// Replaces the values of `password` and `sslpassword` by asterisks. libpq accepts them as parameters of a URL, or in
/// a connection string with or without quotes.
/// Input: `ends` - the characters that end a value without quotes.
void hide_parameters(std::string& store, const char* ends) {
  constexpr std::string_view kName = "password";
  for (std::size_t at = 0; (at = store.find(kName, at)) != std::string::npos;) {
    at = store.find_first_not_of(' ', at + kName.size());
    if (at == std::string::npos || store[at] != '=') continue;
    at = store.find_first_not_of(' ', at + 1);
    if (at == std::string::npos) return;
    // A backslash escapes the character that follows it.
    const std::string_view stop = store[at] == '\'' ? "'" : ends;
    std::size_t end = store[at] == '\'' ? at + 1 : at;
    while (end < store.size() && stop.find(store[end]) == std::string_view::npos) end += store[end] == '\\' ? 2 : 1;
    end = std::min(end + (stop == "'" ? 1 : 0), store.size());
    store.replace(at, end - at, kHidden);
  }
}

std::invalid_argument no_folder(const std::string& folder) {
  return std::invalid_argument("the folder " + folder + " cannot be written");
}

}  // namespace

void check_folders(const JobSettings& settings) {
  if (settings.store == "none") return;
  const bool has_file = settings.store == "sqlite" && settings.state_dir != "auto";
  if (has_file && !could_be_made(settings.state_dir)) throw no_folder(settings.state_dir);
  if (!settings.blob_dir.empty() && !could_be_made(settings.blob_dir)) throw no_folder(settings.blob_dir);
}

std::string find_state_dir(const std::string& state_dir) {
  if (state_dir != "auto") {
    if (!can_be_made(state_dir)) throw no_folder(state_dir);
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
  std::string shown = store;
  const std::size_t scheme = shown.find("://");
  if (scheme != std::string::npos) {
    const std::size_t at = shown.find('@', scheme);
    const std::size_t colon = shown.find(':', scheme + 3);
    if (at != std::string::npos && colon < at) shown.replace(colon + 1, at - colon - 1, kHidden);
  }
  hide_parameters(shown, scheme == std::string::npos ? " " : "&");
  return shown;
}

}  // namespace remesh::server::jobs
