// SPDX-License-Identifier: Apache-2.0
// Heads of requests: what a browser sends is read, everything else is refused with the right status.
#include "view/server/request.h"

#include <gtest/gtest.h>

namespace standoff::view {
namespace {

int status_of(const std::string& head) {
  const auto parsed = parse_head(head);
  return parsed.refusal ? parsed.refusal->status : 200;
}

std::string with_header(const std::string& header) {
  return "GET /t/mesh HTTP/1.1\r\nHost: localhost\r\n" + header + "\r\n\r\n";
}

TEST(Request, OfABrowser) {
  const auto [request, refusal] = parse_head(
      "POST /0af9/compute?id=7&thickness=0.5&name=a%20b+c%3D HTTP/1.1\r\nHost: 127.0.0.1:4000\r\nContent-LENGTH: 12\r\n"
      "Accept:*/*\r\nX-Empty:\r\nCookie: \t a=\xc3\xa9 \r\n\r\n");
  ASSERT_FALSE(refusal);
  EXPECT_EQ(request.method, "POST");
  EXPECT_EQ(request.path, "/0af9/compute");
  EXPECT_EQ(request.body_bytes, 12u);
  ASSERT_TRUE(request.parameter("name"));
  EXPECT_EQ(*request.parameter("name"), "a b c=");
  EXPECT_EQ(*request.parameter("id"), "7");
  EXPECT_EQ(request.parameter("missing"), nullptr);
  EXPECT_EQ(*request.header("host"), "127.0.0.1:4000");
  EXPECT_EQ(*request.header("x-empty"), "");
  EXPECT_EQ(*request.header("cookie"), "a=\xc3\xa9");
}

TEST(Request, PathIsNeverDecoded) {
  const auto parsed = parse_head("GET /t/..%2f%2e%2e/etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n");
  ASSERT_FALSE(parsed.refusal);
  EXPECT_EQ(parsed.request.path, "/t/..%2f%2e%2e/etc/passwd");
}

TEST(Request, MalformedLines) {
  for (const char* line :
       {"", "GET", "GET /", "GET / HTTP/1.1 ", " GET / HTTP/1.1", "GET  / HTTP/1.1", "G\tT / HTTP/1.1",
        "GET http://localhost/ HTTP/1.1", "GET * HTTP/1.1", "GET /\x01 HTTP/1.1", "GET /\xc3\xa9 HTTP/1.1",
        "GET / http/1.1", "GET / HTTP/1.1\n", "GET /?a=%g0 HTTP/1.1", "GET /?a=% HTTP/1.1", "GET /?a=1&a=2 HTTP/1.1",
        "GET /?=1 HTTP/1.1", "GET /?a&&b HTTP/1.1", "{\"a\":1}"})
    EXPECT_EQ(status_of(std::string(line) + "\r\nHost: localhost\r\n\r\n"), 400) << line;
  EXPECT_EQ(status_of("GET / HTTP/1.0\r\nHost: localhost\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / HTTP/2\r\nHost: localhost\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: localhost\r\n"), 400);
}

TEST(Request, MalformedHeaders) {
  EXPECT_EQ(status_of(with_header("A: b")), 200);
  for (const char* header :
       {"A", ": b", "A : b", " A: b", "A: b\r\n c", "A(: b", "A: \x01", "A: b\nC: d", "A: b\rC: d", "\xc3: b",
        "Host: localhost", "Content-Length: 1\r\nContent-Length: 1", "Origin: a\r\nOrigin: a"})
    EXPECT_EQ(status_of(with_header(header)), 400) << header;
  EXPECT_EQ(status_of(with_header(std::string("A: \0", 4))), 400);
}

TEST(Request, BodiesHaveOneLength) {
  for (const char* length : {"", "-1", "+1", "1a", "0x10", "1 1", "1,1", "18446744073709551616"})
    EXPECT_EQ(status_of(with_header(std::string("Content-Length: ") + length)), 400) << length;
  EXPECT_EQ(status_of(with_header("Content-Length: 18446744073709551615")), 200);
  EXPECT_EQ(status_of(with_header("Transfer-Encoding: chunked")), 501);
  EXPECT_EQ(status_of(with_header("Content-Length: 1\r\nTransfer-Encoding: chunked")), 501);
}

TEST(Request, Limits) {
  std::string headers;
  for (std::size_t n = 1; n < kMostHeaders; ++n) headers += "A: b\r\n";
  headers.resize(headers.size() - 2);
  EXPECT_EQ(status_of(with_header(headers)), 200);
  EXPECT_EQ(status_of(with_header(headers + "\r\nA: b")), 431);
  std::string query = "a0";
  for (std::size_t n = 1; n < kMostParameters; ++n) query += "&a" + std::to_string(n);
  EXPECT_TRUE(parse_query(query));
  EXPECT_FALSE(parse_query(query + "&z"));
}

TEST(Request, LengthOfTheHead) {
  EXPECT_EQ(head_length("GET / HTTP/1.1\r\nA: b\r\n\r\nbody"), 24u);
  EXPECT_FALSE(head_length("GET / HTTP/1.1\r\nA: b\r\n\r"));
  EXPECT_FALSE(head_length("GET / HTTP/1.1\n\n"));
}

}  // namespace
}  // namespace standoff::view
