// SPDX-License-Identifier: GPL-2.0-only
// Threads that help the one that calls.

#ifndef MDANIM_TEAM_H
#define MDANIM_TEAM_H

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace mdanim {

// The threads of this process, which all instances share. The caller of share_out() hands out tasks and takes part; a task is
// taken by whichever thread comes first. No one waits for a thread that has no processor: what it does not take others do.
class Team {
 public:
  static constexpr int MOST_TASKS = 32;    // of one call
  using Task = void (*)(void *whose, int task);

  // The team of the process, with at least so many threads, the caller's among them. It ends with its last owner.
  static std::shared_ptr<Team> of(int threads);
  Team() = default;
  Team(const Team &) = delete;
  Team &operator=(const Team &) = delete;
  ~Team();

  // Does all tasks and returns. Thread n prefers task n: what it has in its cache. Where another thread of this process is
  // calling, or in a process that was forked, the caller does them alone.
  void share_out(int tasks, Task task, void *whose);

 private:
  void grow(int threads);
  void help(int member);
  bool take(std::uint32_t call, int preferred, int &task);
  void work(std::uint32_t call, int member);

  std::vector<std::thread> helpers;
  int owner = 0;    // the process that has started them
  std::atomic_flag called = ATOMIC_FLAG_INIT;

  // The number of the call, and a bit for each task that is taken or not there. A thread that comes late finds another number or
  // all bits set; one that has set a bit knows that the call goes on until its task is done.
  alignas(64) std::atomic<std::uint64_t> state{0xffffffffu};    // no call yet, and no task
  alignas(64) std::atomic<int> done{0};
  Task task = nullptr;
  void *whose = nullptr;
  unsigned rounding = 0;    // the caller's mode of floating-point numbers

  alignas(64) std::atomic<int> asleep{0};
  std::atomic<bool> over{false};
  std::mutex door;
  std::condition_variable bell;
};

// What an instance has of the team of its process: so many threads.
class Threads {
 public:
  // `least`: the least that a thread is asked for [ns]. Two tasks that take less had better be done by one thread.
  explicit Threads(int many = 1, double least = 0.0) : number(many), least_task(least), team(Team::of(many)) {}
  int many() const { return number; }
  double least() const { return least_task; }

  // work(n) for n from 0 to tasks - 1, of which there are MOST_TASKS at most.
  template <class Work> void each(int tasks, const Work &work) const
  {
    const auto one = [](void *of_whom, int n) { (*static_cast<const Work *>(of_whom))(n); };
    team->share_out(tasks, one, const_cast<Work *>(&work));
  }
  // work(first, end) for parts of all numbers from 0 to size - 1: several for each thread, for one may cost more than another,
  // and none shorter than `least`.
  template <class Work> void parts(long size, long least, const Work &work) const
  {
    const long wanted = number < 2 ? 1 : std::min<long>(number * PARTS_OF_ONE, Team::MOST_TASKS);
    const long many = std::min(wanted, size / least);
    if (many < 2) return work(0L, size);
    each(static_cast<int>(many), [&](int n) { work(size * n / many, size * (n + 1) / many); });
  }
  // The same where each number takes about so many ns: a part may be shorter than the least task, as some cost more than others
  // and loops come one after the other.
  template <class Work> void timed_parts(long size, double ns, const Work &work) const
  {
    constexpr double PART = 0.25;    // of the least task
    parts(size, 1 + static_cast<long>(PART * least_task / ns), work);
  }

 private:
  static constexpr int PARTS_OF_ONE = 4;

  int number;
  double least_task;
  std::shared_ptr<Team> team;
};

}    // namespace mdanim

#endif
