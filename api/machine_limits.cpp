#include "api/machine_limits.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace remesh::api {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Returns the contents of a file of our control group (version 2) and of all groups above it, because each of them
/// may set a limit.
std::vector<std::string> of_cgroups(const std::string& file) {
  std::istringstream groups(contents("/proc/self/cgroup"));
  std::vector<std::string> found;
  for (std::string line; std::getline(groups, line);) {
    if (line.rfind("0::", 0) != 0) continue;
    for (std::string path = line.substr(3);; path.erase(path.rfind('/'))) {
      found.push_back(contents(std::string("/sys/fs/cgroup").append(path).append("/").append(file)));
      if (path.empty() || path.rfind('/') == std::string::npos) break;
    }
  }
  return found;
}

std::vector<std::string> cpu_quotas() {
  std::vector<std::string> quotas = of_cgroups("cpu.max");
  const std::string version_1 = "/sys/fs/cgroup/cpu/cpu.cfs_";
  quotas.push_back(contents(version_1 + "quota_us") + " " + contents(version_1 + "period_us"));
  return quotas;
}

std::vector<std::string> memory_limits() {
  std::vector<std::string> limits = of_cgroups("memory.max");
  limits.push_back(contents("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
  return limits;
}

/// The memory of this process in bytes; 0 if it cannot be found out.
struct MemoryInUse {
  std::uint64_t resident = 0;
  std::uint64_t writable = 0;  ///< all writable memory, touched or not
};

MemoryInUse memory_in_use() {
  unsigned long long total = 0, resident = 0, shared = 0, text = 0, libraries = 0, data = 0;
  std::FILE* statm = std::fopen("/proc/self/statm", "re");
  if (statm == nullptr) return {};
  const bool is_read =
      std::fscanf(statm, "%llu %llu %llu %llu %llu %llu", &total, &resident, &shared, &text, &libraries, &data) == 6;
  std::fclose(statm);
  if (!is_read) return {};
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  return {resident * page, data * page};
}

}  // namespace

int cores_of_quota(const char* cpu_max) {
  long long quota = 0;
  long long period = 0;
  if (std::sscanf(cpu_max, "%lld %lld", &quota, &period) != 2 || quota <= 0 || period <= 0) return 0;
  return static_cast<int>((quota + period - 1) / period);
}

int usable_cores() {
  int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  cpu_set_t set;
  if (::sched_getaffinity(0, sizeof set, &set) == 0) cores = CPU_COUNT(&set);
  for (const std::string& quota : cpu_quotas()) {
    if (const int granted = cores_of_quota(quota.c_str()); granted > 0) cores = std::min(cores, granted);
  }
  return std::max(1, cores);
}

std::uint64_t usable_memory() {
  std::uint64_t bytes =
      static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  for (const std::string& limit : memory_limits()) {
    // The file contains "max" if there is no limit, which reads as 0.
    if (const std::uint64_t granted = std::strtoull(limit.c_str(), nullptr, 10); granted > 0)
      bytes = std::min(bytes, granted);
  }
  rlimit address_space{};
  if (::getrlimit(RLIMIT_AS, &address_space) == 0) bytes = std::min<std::uint64_t>(bytes, address_space.rlim_cur);
  return bytes;
}

std::uint64_t resident_memory() { return memory_in_use().resident; }

bool limit_own_memory(std::uint64_t bytes) {
  rlimit data{};
  if (::getrlimit(RLIMIT_DATA, &data) != 0 || memory_in_use().writable >= bytes) return false;
  data.rlim_cur = std::min<std::uint64_t>({bytes, data.rlim_cur, data.rlim_max});
  return ::setrlimit(RLIMIT_DATA, &data) == 0;
}

}  // namespace remesh::api
