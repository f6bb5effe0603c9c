#include "tests/mutate/child_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <system_error>

#include "tests/support/sanitizer.h"

namespace remesh::mutate {
namespace {

constexpr std::size_t kMaxErrorText = 4000;

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

void write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = write(file, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(3);
    done += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void be_child(const std::function<void(const Send&)>& work, int pipe, std::size_t max_mb) {
  // A crash is reported, but nobody looks at the memory, so no core file is written.
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  if (max_mb > 0 && !kIsSanitized) {
    const rlimit memory{max_mb << 20, max_mb << 20};
    setrlimit(RLIMIT_AS, &memory);
  }
  try {
    work([pipe](const std::string& text) { write_all(pipe, text); });
  } catch (const std::exception& error) {
    write_all(STDERR_FILENO, std::string("the child itself failed: ") + error.what() + "\n");
    std::abort();
  }
  _exit(0);
}

std::string end_of_file(int file) {
  const off_t size = lseek(file, 0, SEEK_END);
  const off_t begin = std::max<off_t>(0, size - static_cast<off_t>(kMaxErrorText));
  std::string text(static_cast<std::size_t>(std::max<off_t>(size - begin, 0)), '\0');
  const ssize_t count = pread(file, text.data(), text.size(), begin);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return text;
}

}  // namespace

ChildPool::ChildPool(std::size_t max_children, std::size_t max_mb, double max_life_s)
    : max_children_(std::max<std::size_t>(max_children, 1)), max_mb_(max_mb), max_life_s_(max_life_s) {}

ChildPool::~ChildPool() {
  for (Child& child : children_) {
    kill(child.pid, SIGKILL);
    waitpid(child.pid, nullptr, 0);
    close(child.pipe);
    close(child.error_file);
  }
}

void ChildPool::start(std::uint64_t number, const std::function<void(const Send&)>& work) {
  int ends[2];
  if (pipe(ends) != 0) fail("pipe");
  const int error_file = memfd_create("standard error", 0);
  if (error_file < 0) fail("memfd_create");
  const pid_t pid = fork();
  if (pid < 0) fail("fork");
  if (pid == 0) {
    close(ends[0]);
    dup2(error_file, STDERR_FILENO);
    be_child(work, ends[1], max_mb_);
  }
  close(ends[1]);
  children_.push_back({number, pid, ends[0], error_file, std::chrono::steady_clock::now(), {}});
}

ChildEnd ChildPool::wait() {
  constexpr int kLookEveryMs = 200;
  for (;;) {
    std::vector<pollfd> files;
    for (const Child& child : children_) files.push_back({child.pipe, POLLIN, 0});
    if (poll(files.data(), files.size(), kLookEveryMs) < 0 && errno != EINTR) fail("poll");
    for (std::size_t i = 0; i < children_.size(); ++i) {
      Child& child = children_[i];
      if (files[i].revents != 0) {
        char bytes[65536];
        const ssize_t count = read(child.pipe, bytes, sizeof bytes);
        if (count > 0) {
          child.message.append(bytes, static_cast<std::size_t>(count));
        } else {
          ChildEnd end = end_of(child);
          children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
          return end;
        }
      }
      const std::chrono::duration<double> life = std::chrono::steady_clock::now() - child.start;
      if (life.count() > max_life_s_ && !child.was_killed) {
        child.was_killed = true;
        kill(child.pid, SIGKILL);
      }
    }
  }
}

ChildEnd ChildPool::end_of(Child& child) {
  int status = 0;
  rusage usage{};
  wait4(child.pid, &status, 0, &usage);
  ChildEnd end;
  end.number = child.number;
  end.message = std::move(child.message);
  end.standard_error = end_of_file(child.error_file);
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0)
    end.standard_error += "\nexit code " + std::to_string(WEXITSTATUS(status));
  end.was_killed = child.was_killed;
  end.max_mb = static_cast<double>(usage.ru_maxrss) / 1024;
  close(child.pipe);
  close(child.error_file);
  return end;
}

}  // namespace remesh::mutate
