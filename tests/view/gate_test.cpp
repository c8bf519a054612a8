// SPDX-License-Identifier: Apache-2.0
// Who may come in to the page's server.
#include "view/server/request.h"

#include <gtest/gtest.h>

#include <set>

namespace standoff::view {
namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";

struct Case {
  std::string method = "GET", path = "/" + kToken + "/mesh", host = "127.0.0.1:4000";
  std::vector<std::pair<std::string, std::string>> headers = {};
};

bool comes_in(const Case& it) {
  Request request;
  request.method = it.method;
  request.path = it.path;
  request.headers = it.headers;
  if (!it.host.empty()) request.headers.emplace_back("host", it.host);
  return !Gate(kToken).check(request);
}

TEST(Gate, TokensAreLongAndDiffer) {
  std::set<std::string> tokens;
  for (int n = 0; n < 100; ++n) tokens.insert(random_token());
  EXPECT_EQ(tokens.size(), 100u);
  for (const std::string& token : tokens) {
    EXPECT_EQ(token.size(), 32u);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

TEST(Gate, ComparesAllOfAToken) {
  EXPECT_TRUE(same_token(kToken, kToken));
  EXPECT_FALSE(same_token(kToken, ""));
  EXPECT_FALSE(same_token("", ""));
  EXPECT_FALSE(same_token("", "a"));
  EXPECT_FALSE(same_token(kToken, kToken.substr(1)));
  EXPECT_FALSE(same_token(kToken, kToken + kToken));
  for (std::size_t n = 0; n < kToken.size(); ++n) {
    std::string other = kToken;
    other[n] ^= 1;
    EXPECT_FALSE(same_token(kToken, other)) << n;
  }
}

TEST(Gate, TokenIsTheFirstFolder) {
  EXPECT_TRUE(comes_in({}));
  EXPECT_TRUE(comes_in({.path = "/" + kToken + "/"}));
  for (const std::string& path :
       {std::string("/"), std::string("//"), "/" + kToken, "//" + kToken + "/", kToken + "/", "/x/" + kToken + "/",
        "/" + kToken.substr(1) + "/", "/" + kToken + "a/", std::string("/0123456789ABCDEF0123456789ABCDEF/"),
        std::string("/%30123456789abcdef0123456789abcdef/")})
    EXPECT_FALSE(comes_in({.path = path})) << path;
}

TEST(Gate, RouteIsWhatFollows) {
  Request request;
  request.path = "/" + kToken + "/mesh";
  EXPECT_EQ(Gate(kToken).route(request), "mesh");
  request.path = "/" + kToken + "/";
  EXPECT_EQ(Gate(kToken).route(request), "");
}

TEST(Gate, HostIsLoopback) {
  for (const char* host : {"localhost", "localhost:1", "127.0.0.1:65535", "127.0.0.1", "[::1]:8080", "[::1]"})
    EXPECT_TRUE(is_loopback_host(host)) << host;
  for (const char* host :
       {"", "evil.example", "localhost.evil.example", "127.0.0.1.evil.example:80", "localhost:", "localhost:a",
        "localhost:123456", "localhost:80:80", "127.0.0.2", "0.0.0.0", "[::]", "::1", "user@localhost"})
    EXPECT_FALSE(is_loopback_host(host)) << host;
  EXPECT_FALSE(comes_in({.host = ""}));
  EXPECT_FALSE(comes_in({.host = "rebound.example:4000"}));
}

TEST(Gate, OriginIsThePagesOwn) {
  EXPECT_TRUE(comes_in({.headers = {{"origin", "http://127.0.0.1:4000"}}}));
  for (const char* origin : {"", "null", "http://127.0.0.1:4001", "http://localhost:4000", "https://127.0.0.1:4000",
                             "http://evil.example", "http://127.0.0.1:4000/", "file://"})
    EXPECT_FALSE(comes_in({.headers = {{"origin", origin}}})) << origin;
}

TEST(Gate, OtherSitesMayLinkAndNoMore) {
  EXPECT_TRUE(comes_in({.headers = {{"sec-fetch-site", "same-origin"}, {"sec-fetch-mode", "cors"}}}));
  EXPECT_TRUE(comes_in({.headers = {{"sec-fetch-site", "none"}, {"sec-fetch-mode", "navigate"}}}));
  EXPECT_TRUE(comes_in({.headers = {{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", "navigate"}}}));
  EXPECT_FALSE(
      comes_in({.method = "POST", .headers = {{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", "navigate"}}}));
  for (const char* site : {"cross-site", "same-site", ""})
    for (const char* mode : {"cors", "no-cors", "websocket", ""})
      EXPECT_FALSE(comes_in({.headers = {{"sec-fetch-site", site}, {"sec-fetch-mode", mode}}})) << site << ' ' << mode;
}

}  // namespace
}  // namespace standoff::view
