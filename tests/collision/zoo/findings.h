// SPDX-License-Identifier: Apache-2.0
// What random questions found: how many answers were wrong, how, and the farthest that an answer was off.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>

#include "standoff/vec.h"

namespace standoff::testing {

class Findings {
 public:
  /// All that follows was asked about these bodies and this pose: what to ask for to see it again.
  void at(unsigned seed, long pose) { seed_ = seed, pose_ = pose; }

  void count(const char* what, long many = 1) { counts_[what] += many; }
  long counted(const char* what) const {
    const auto it = counts_.find(what);
    return it == counts_.end() ? 0 : it->second;
  }

  /// An answer that must not be.
  void wrong(const char* what, long many = 1) {
    if (many <= 0) return;
    Wrong& it = wrong_[what];
    if (it.many == 0) it.first = here();
    it.many += many;
  }
  void expect(bool right, const char* what) { wrong(what, right ? 0 : 1); }

  /// An answer that is off by so much, which must be no more than is allowed.
  void off(const char* what, double by, double allowed) {
    Worst& it = worst_[what];
    const double share = by <= 0 ? 0 : by / allowed;
    ++it.asked;
    it.beyond += !(share <= 1);
    if (share <= it.share) return;
    it.share = share;
    it.where = here();
  }

  void print() const {
    for (const auto& [what, many] : counts_) std::printf("  %12ld %s\n", many, what.c_str());
    for (const auto& [what, it] : worst_)
      std::printf("  %12.3g of what is allowed at the most, of %ld: %s; %s\n", it.share, it.asked, what.c_str(),
                  it.where.c_str());
    for (const auto& [what, it] : wrong_)
      std::printf("  %12ld WRONG: %s; first at %s\n", it.many, what.c_str(), it.first.c_str());
    std::fflush(stdout);
  }
  void expect_none() const {
    print();
    for (const auto& [what, it] : wrong_) ADD_FAILURE() << it.many << " times: " << what << "; first at " << it.first;
    for (const auto& [what, it] : worst_)
      EXPECT_EQ(it.beyond, 0) << what << ": off by up to " << it.share << " of what is allowed, at " << it.where;
  }

 private:
  struct Wrong {
    long many = 0;
    std::string first;
  };
  struct Worst {
    double share = 0;
    long asked = 0, beyond = 0;
    std::string where = "never off";
  };
  std::string here() const { return "seed " + std::to_string(seed_) + ", pose " + std::to_string(pose_); }

  unsigned seed_ = 0;
  long pose_ = 0;
  std::map<std::string, long> counts_;
  std::map<std::string, Wrong> wrong_;
  std::map<std::string, Worst> worst_;
};

}  // namespace standoff::testing
