// SPDX-License-Identifier: Apache-2.0
// The interpreter's lock, for threads that may outlive the interpreter.
//
// If Python ends while a daemon thread is in here, the thread's next attempt to take the lock ends it: CPython up
// to 3.13 calls pthread_exit, which unwinds the stack. nanobind's guards take the lock in a destructor, which must not
// be unwound, and the whole process would abort. These guards let such a thread wait for the end of the process
// instead, as CPython does from 3.14 on.
//
// The same may happen wherever Python code runs: it gives the lock away now and then, and takes it again. Call it
// through ask_python.
#pragma once

#include <chrono>
#include <thread>

#include "common.h"

namespace standoff::python {

/// Waits for the end of the process. Call it where the unwinding of pthread_exit is caught: it must not be swallowed.
[[noreturn]] inline void wait_for_exit() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// ask(), a call of Python's C functions that may run Python code. These throw nothing, so that what unwinds them is
/// the end of this thread. Within ask, nothing with a destructor may live: Python's objects must not be freed without
/// the lock.
template <class Ask>
auto ask_python(const Ask& ask) {
  // A destructor, because nothing foreign can be caught while an exception is handled (std::terminate), and nanobind
  // has errors translated while it handles them.
  struct Unwound {
    bool returned = false;
    ~Unwound() {
      if (!returned) wait_for_exit();
    }
  } unwound;
  const auto answer = ask();
  unwound.returned = true;
  return answer;
}

/// A process that is forked while other threads work has their mutexes, taken, but not the threads, and would wait for
/// ever. begin_work throws in such a process. Errors: usage.
void begin_work();
void end_work() noexcept;

/// Gives the lock back to others while it lives, for the library's work. Errors: usage (see begin_work).
class Unlocked {
 public:
  Unlocked() : state_((begin_work(), PyEval_SaveThread())) {}
  ~Unlocked() {
    end_work();
    try {
      PyEval_RestoreThread(state_);
    } catch (...) {
      wait_for_exit();
    }
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Has the lock while it lives, within the life of an Unlocked.
class Locked {
 public:
  Locked() : state_(take()) {}
  ~Locked() { PyGILState_Release(state_); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

 private:
  static PyGILState_STATE take() {
    try {
      return PyGILState_Ensure();
    } catch (...) {
      wait_for_exit();
    }
  }
  PyGILState_STATE state_;
};

}  // namespace standoff::python
