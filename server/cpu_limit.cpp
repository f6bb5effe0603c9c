#include "server/cpu_limit.h"

#include <sched.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace remesh::server {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Folders of our control group up to the root: every one of them may set a quota.
int cores_of_cgroup_v2() {
  std::istringstream groups(contents("/proc/self/cgroup"));
  int cores = 0;
  for (std::string line; std::getline(groups, line);) {
    if (line.rfind("0::", 0) != 0) continue;
    for (std::string path = line.substr(3);; path.erase(path.rfind('/'))) {
      const int here = cores_of_quota(contents("/sys/fs/cgroup" + path + "/cpu.max").c_str());
      if (here > 0) cores = cores == 0 ? here : std::min(cores, here);
      if (path.empty() || path.rfind('/') == std::string::npos) break;
    }
  }
  return cores;
}

int cores_of_cgroup_v1() {
  const std::string quota = contents("/sys/fs/cgroup/cpu/cpu.cfs_quota_us");
  return cores_of_quota((quota + " " + contents("/sys/fs/cgroup/cpu/cpu.cfs_period_us")).c_str());
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
  for (const int quota : {cores_of_cgroup_v2(), cores_of_cgroup_v1()}) {
    if (quota > 0) cores = std::min(cores, quota);
  }
  return std::max(1, cores);
}

}  // namespace remesh::server
