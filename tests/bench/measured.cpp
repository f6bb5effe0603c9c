/// Runs a program to its end: `measured FILE PROGRAM ARGUMENT...` writes the seconds and the peak of memory to the
/// file, as JSON, and exits as the program did. It stands between a script and the program, because the kernel counts
/// the memory of the process that starts a program towards the program's peak.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: measured FILE PROGRAM [ARGUMENT]...\n");
    return 2;
  }
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    execvp(argv[2], argv + 2);
    std::perror(argv[2]);
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child) {
    std::perror("measured");
    return 1;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::FILE* file = std::fopen(argv[1], "w");
  if (file == nullptr) {
    std::perror(argv[1]);
    return 1;
  }
  std::fprintf(file,
               R"({"seconds": %.6f, "peak_bytes": %lld})"
               "\n",
               took.count(), 1024LL * usage.ru_maxrss);
  const bool is_written = std::fclose(file) == 0;
  return is_written && WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
