// SPDX-License-Identifier: Apache-2.0
#include "gpu/emulation/fiber.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

#ifdef STANDOFF_HAVE_BOOST_CONTEXT
#include <boost/context/detail/fcontext.hpp>
#else
#include <ucontext.h>
#endif

#ifndef __has_feature
#define __has_feature(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#define STANDOFF_ASAN 1
#include <sanitizer/common_interface_defs.h>
#endif
#if defined(__SANITIZE_THREAD__) || __has_feature(thread_sanitizer)
#define STANDOFF_TSAN 1
#include <sanitizer/tsan_interface.h>
#endif

// The switches themselves are no business of the thread sanitizer: it would take the bookkeeping for races.
#define STANDOFF_UNWATCHED __attribute__((no_sanitize("thread")))

namespace standoff::emulation {
namespace {

constexpr std::size_t kGuardBytes = 4096;

// The stack of the thread that resumes fibers. One emulated launch runs at a time (block.cpp), so one is enough.
struct {
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  boost::context::detail::fcontext_t context;
#else
  ucontext_t context;
#endif
  const void* stack_bottom;
  std::size_t stack_bytes;
  void* tsan;
} home;

void (*entry_of_next)();

}  // namespace

struct Fiber::Context {
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  boost::context::detail::fcontext_t context{};
#else
  ucontext_t context{};
#endif
  void* asan_fake_stack = nullptr;
  void* tsan = nullptr;
  bool ended = false;
};

namespace {

STANDOFF_UNWATCHED void arrive_first() {
#ifdef STANDOFF_ASAN
  __sanitizer_finish_switch_fiber(nullptr, &home.stack_bottom, &home.stack_bytes);
#endif
  entry_of_next();
  std::abort();  // entries end with finish()
}

#ifdef STANDOFF_HAVE_BOOST_CONTEXT
STANDOFF_UNWATCHED void arrive(boost::context::detail::transfer_t from) {
  home.context = from.fctx;
  arrive_first();
}
#else
STANDOFF_UNWATCHED void arrive() { arrive_first(); }
#endif

}  // namespace

Fiber::Fiber() : context_(new Context) {
  void* memory = mmap(nullptr, kGuardBytes + kStackBytes, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED || mprotect(memory, kGuardBytes, PROT_NONE) != 0) {
    delete context_;
    throw std::bad_alloc();
  }
  stack_ = static_cast<char*>(memory) + kGuardBytes;
}

Fiber::~Fiber() {
#ifdef STANDOFF_TSAN
  if (context_->tsan) __tsan_destroy_fiber(context_->tsan);
#endif
  munmap(stack_ - kGuardBytes, kGuardBytes + kStackBytes);
  delete context_;
}

STANDOFF_UNWATCHED void Fiber::start(void (*entry)()) {
  entry_of_next = entry;
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  context_->context = boost::context::detail::make_fcontext(stack_ + kStackBytes, kStackBytes, arrive);
#else
  getcontext(&context_->context);
  context_->context.uc_stack.ss_sp = stack_;
  context_->context.uc_stack.ss_size = kStackBytes;
  context_->context.uc_link = nullptr;
  makecontext(&context_->context, arrive, 0);
#endif
#ifdef STANDOFF_TSAN
  // Making one takes a millisecond: only where the last run was given up midway.
  if (context_->tsan && !context_->ended) {
    __tsan_destroy_fiber(context_->tsan);
    context_->tsan = nullptr;
  }
  if (!context_->tsan) context_->tsan = __tsan_create_fiber(0);
#endif
  context_->ended = false;
}

STANDOFF_UNWATCHED void Fiber::resume() {
#ifdef STANDOFF_ASAN
  void* fake_stack = nullptr;
  __sanitizer_start_switch_fiber(&fake_stack, stack_, kStackBytes);
#endif
#ifdef STANDOFF_TSAN
  home.tsan = __tsan_get_current_fiber();
  __tsan_switch_to_fiber(context_->tsan, __tsan_switch_to_fiber_no_sync);  // taking turns orders nothing
#endif
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  context_->context = boost::context::detail::jump_fcontext(context_->context, nullptr).fctx;
#else
  swapcontext(&home.context, &context_->context);
#endif
#ifdef STANDOFF_ASAN
  __sanitizer_finish_switch_fiber(fake_stack, nullptr, nullptr);
#endif
}

STANDOFF_UNWATCHED void Fiber::leave(bool for_good) {
  context_->ended = for_good;
#ifdef STANDOFF_TSAN
  __tsan_switch_to_fiber(home.tsan, __tsan_switch_to_fiber_no_sync);
#endif
#ifdef STANDOFF_ASAN
  __sanitizer_start_switch_fiber(for_good ? nullptr : &context_->asan_fake_stack, home.stack_bottom, home.stack_bytes);
#endif
#ifdef STANDOFF_HAVE_BOOST_CONTEXT
  home.context = boost::context::detail::jump_fcontext(home.context, nullptr).fctx;
#else
  swapcontext(&context_->context, &home.context);
#endif
#ifdef STANDOFF_ASAN
  __sanitizer_finish_switch_fiber(context_->asan_fake_stack, &home.stack_bottom, &home.stack_bytes);
#endif
}

STANDOFF_UNWATCHED void Fiber::park() { leave(false); }

STANDOFF_UNWATCHED void Fiber::finish() {
  leave(true);
  std::abort();  // a finished fiber is started again, never resumed
}

void release([[maybe_unused]] void* tag) {
#ifdef STANDOFF_TSAN
  __tsan_release(tag);
#endif
}

void acquire([[maybe_unused]] void* tag) {
#ifdef STANDOFF_TSAN
  __tsan_acquire(tag);
#endif
}

}  // namespace standoff::emulation
