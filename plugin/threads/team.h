// SPDX-License-Identifier: GPL-2.0-only
// Threads that help the calling thread.

#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace mdanim {

// The threads of this process, which all instances share. The caller of share_out() hands out tasks and takes part. A task is
// taken by whichever thread comes first. No thread waits for one that has no processor: others do its tasks.
class Team {
 public:
  static constexpr int MOST_TASKS = 32;    // of one call
  using Task = void (*)(void *whose, int task);

  // The team of the process, with at least `threads` threads, the caller's among them. It ends with its last owner.
  static std::shared_ptr<Team> of(int threads);
  Team() = default;
  Team(const Team &) = delete;
  Team &operator=(const Team &) = delete;
  ~Team();

  // Whether to share out tasks that take `ns` together. Sleeping threads are woken once the caller has done work of `worth` ns
  // alone since they fell asleep. So waking costs a fixed part of the shared work, however short each call is.
  bool is_ready(double ns, double worth);
  // Does all tasks and returns. Thread n prefers task n, whose data are in its cache. The caller does all tasks alone if another
  // thread of this process is calling, or in a forked process. An exception of a task is thrown when all tasks are done; of
  // several exceptions one is thrown.
  void share_out(int tasks, Task task, void *whose);

 private:
  static void end_of_process_that_made(Team *team);
  void grow(int threads);
  void help(int member);
  bool take(std::uint32_t call, int preferred, int &task);
  void work(std::uint32_t call, int member);

  std::vector<std::thread> helpers;
  int owner = 0;    // the process that has started them
  std::atomic_flag called = ATOMIC_FLAG_INIT;

  // The number of the call, and a bit for each task that is taken or does not exist. A thread that comes late finds another
  // number or all bits set. A thread that has set a bit knows that the call lasts until its task is done.
  alignas(64) std::atomic<std::uint64_t> state{0xffffffffu};    // no call yet, no task
  alignas(64) std::atomic<int> done{0};
  Task task = nullptr;
  void *whose = nullptr;
  unsigned rounding = 0;         // the caller's mode of floating-point numbers
  std::exception_ptr failure;    // of a task, under `door`

  alignas(64) std::atomic<int> asleep{0};
  std::atomic<double> alone{0.0};    // [ns] of work that the caller has done because others slept
  std::atomic<bool> over{false};
  std::mutex door;
  std::condition_variable bell;
};

// An instance's share of the team of its process: a number of threads.
class Threads {
 public:
  // `least`: the shortest work for which another thread is used [ns]; one thread is faster for two tasks that take less.
  // `waking`: the time that a thread takes to wake up [ns].
  explicit Threads(int many = 1, double least = 0.0, double waking = 0.0)
      : number(many), least_task(least), waking(waking), team(Team::of(many))
  {
  }
  // For steps of a run: another thread is used for work that pays on most processors, or for what MDANIM_LEAST_TASK [ns] in the
  // environment says.
  static Threads of_run(int many);
  int many() const { return number; }
  // How many threads to use for work that takes one thread `ns` nanoseconds.
  int most(double ns) const
  { return static_cast<int>(std::clamp(ns / std::max(least_task, 1.0), 1.0, 1.0 * std::min(number, Team::MOST_TASKS))); }
  // Whether it is better to share the work now.
  bool pays(double ns) const { return most(ns) > 1 && team->is_ready(ns, 2.0 * waking); }

  // Calls work(n) for n from 0 to tasks - 1, MOST_TASKS at most; all together take one thread `ns` nanoseconds.
  template <class Work> void each(int tasks, double ns, const Work &work) const
  {
    if (pays(ns)) return share_out(tasks, work);
    for (int n = 0; n < tasks; ++n) work(n);
  }
  // Calls work(first, end) for parts of all numbers from 0 to size - 1, each of which takes about `ns` nanoseconds. There are
  // several parts for each thread, because one may cost more than another.
  template <class Work> void parts(long size, double ns, const Work &work, int for_each_thread = 4) const
  {
    const double all = ns * static_cast<double>(size);
    const long many = std::min<long>({size, for_each_thread * most(all), Team::MOST_TASKS});
    if (many < 2 || !pays(all)) return work(0L, size);
    share_out(static_cast<int>(many), [&](long n) { work(size * n / many, size * (n + 1) / many); });
  }

 private:
  template <class Work> void share_out(int tasks, const Work &work) const
  {
    const auto one = [](void *of_whom, int n) { (*static_cast<const Work *>(of_whom))(n); };
    team->share_out(tasks, one, const_cast<Work *>(&work));
  }

  int number;
  double least_task, waking;
  std::shared_ptr<Team> team;
};

}    // namespace mdanim
