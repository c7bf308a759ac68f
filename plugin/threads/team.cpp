// SPDX-License-Identifier: GPL-2.0-only
// Threads that take tasks, wait and sleep.

#include "threads/team.h"

#include "threads/waiting.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cstdlib>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace mdanim {

namespace {

// Flush to zero and similar modes: in another mode a helper would compute other bits than the caller.
unsigned floating_point_mode()
{
#if defined(__SSE__)
  return _mm_getcsr();
#elif defined(__aarch64__)
  unsigned long mode;
  asm volatile("mrs %0, fpcr" : "=r"(mode));
  return static_cast<unsigned>(mode);
#else
  return 0;
#endif
}

void set_floating_point_mode(unsigned mode)
{
#if defined(__SSE__)
  _mm_setcsr(mode);
#elif defined(__aarch64__)
  asm volatile("msr fpcr, %0" ::"r"(static_cast<unsigned long>(mode)));
#else
  (void) mode;
#endif
}

// Whether a caller leaves all tasks to others and sleeps, so that its processor time is that of what is not shared
// (bench/threads.py).
bool caller_rests()
{
  static const bool asked = std::getenv("MDANIM_CALLER_RESTS");
  return asked;
}

std::uint32_t call_of(std::uint64_t state) { return static_cast<std::uint32_t>(state >> 32); }

}    // namespace

// A fork copies no threads. The memory that it copies says that threads sleep, and cannot be destroyed: the destructor of a
// condition variable waits for these. So it is left as it is.
void Team::end_of_process_that_made(Team *team)
{
  if (team->owner == getpid()) delete team;
}

// LEAST_TASK is ten times the overhead of a call when the threads are awake: about as much again goes into moving data from one
// core to another. WAKING is the time that a thread takes to wake up (bench/team.py).
static constexpr double LEAST_TASK = 4e3, WAKING = 12e3;    // [ns]

Threads Threads::of_run(int many)
{
  const char *const told = std::getenv("MDANIM_LEAST_TASK");
  const double least = told ? std::atof(told) : 0.0;
  return least > 0.0 ? Threads(many, least, WAKING / LEAST_TASK * least) : Threads(many, LEAST_TASK, WAKING);
}

std::shared_ptr<Team> Team::of(int threads)
{
  static std::mutex one_at_a_time;
  static std::weak_ptr<Team> known;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  std::shared_ptr<Team> team = known.lock();
  if (!team || team->owner != getpid()) known = team = std::shared_ptr<Team>(new Team, end_of_process_that_made);
  team->grow(threads);
  return team;
}

void Team::grow(int threads)
{
  owner = getpid();
  sigset_t all, before;    // signals are left to the threads of the host program
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  while (static_cast<int>(helpers.size()) + 1 < threads)
    helpers.emplace_back([this, member = static_cast<int>(helpers.size()) + 1] { help(member); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Team::~Team()
{
  {
    const std::lock_guard<std::mutex> lock(door);
    over = true;
  }
  bell.notify_all();
  for (std::thread &helper : helpers) helper.join();
}

bool Team::is_ready(double ns, double worth)
{
  if (!asleep.load(std::memory_order_relaxed) || caller_rests()) return true;
  const double left = alone.load(std::memory_order_relaxed) + ns;
  if (left >= worth) return true;
  alone.store(left, std::memory_order_relaxed);
  return false;
}

void Team::share_out(int tasks, Task what, void *of_whom)
{
  if (helpers.empty() || tasks < 2 || owner != getpid() || called.test_and_set(std::memory_order_acquire)) {
    for (int n = 0; n < tasks; ++n) what(of_whom, n);
    return;
  }
  task = what;
  whose = of_whom;
  rounding = floating_point_mode();
  failure = nullptr;
  done.store(0, std::memory_order_relaxed);
  const std::uint32_t call = call_of(state.load(std::memory_order_relaxed)) + 1;
  const std::uint64_t missing = ~std::uint64_t{0} << tasks & 0xffffffffu;
  state.store(static_cast<std::uint64_t>(call) << 32 | missing);    // before `asleep` is read
  if (asleep.load()) {
    {
      const std::lock_guard<std::mutex> lock(door);
    }    // a thread that is between its last look and its sleep
    bell.notify_all();
    alone.store(0.0, std::memory_order_relaxed);
  }
  const auto is_done = [&] { return done.load(std::memory_order_acquire) == tasks; };
  if (caller_rests()) {
    std::unique_lock<std::mutex> lock(door);
    bell.wait(lock, is_done);
  } else {
    work(call, 0);
  }
  wait_until(is_done);
  const std::exception_ptr failed = failure;
  called.clear(std::memory_order_release);
  if (failed) std::rethrow_exception(failed);
}

bool Team::take(std::uint32_t call, int preferred, int &taken)
{
  std::uint64_t now = state.load(std::memory_order_acquire);
  for (;;) {
    const std::uint32_t open = ~static_cast<std::uint32_t>(now);
    if (call_of(now) != call || !open) return false;
    const std::uint32_t later = preferred < MOST_TASKS ? open >> preferred << preferred : 0;
    taken = __builtin_ctz(later ? later : open);
    if (state.compare_exchange_weak(now, now | std::uint64_t{1} << taken, std::memory_order_acq_rel)) return true;
  }
}

void Team::work(std::uint32_t call, int member)
{
  for (int taken; take(call, member, taken);) {
    if (member) set_floating_point_mode(rounding);
    try {
      task(whose, taken);
    } catch (...) {    // rethrown by the caller when all tasks are done
      const std::lock_guard<std::mutex> lock(door);
      if (!failure) failure = std::current_exception();
    }
    done.fetch_add(1, std::memory_order_release);
  }
  if (member && caller_rests()) {
    {
      const std::lock_guard<std::mutex> lock(door);
    }    // a caller that is between its last look and its sleep
    bell.notify_all();
  }
}

void Team::help(int member)
{
  std::uint32_t seen = 0;
  const auto called_again = [&] { return over || call_of(state.load()) != seen; };
  while (!over) {
    if (!wait_for(called_again)) {
      std::unique_lock<std::mutex> lock(door);
      ++asleep;
      bell.wait(lock, called_again);
      --asleep;
    }
    seen = call_of(state.load());
    work(seen, member);
  }
}

}    // namespace mdanim
