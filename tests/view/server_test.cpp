// SPDX-License-Identifier: Apache-2.0
// The page's server over real sockets: hostile, slow and many clients, and one that should be served all the while.
// labels: memory threads
#include "view/server/server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <random>
#include <thread>

#include "files/atomic_file.h"
#include "standoff/error.h"
#include "tests/support/paths.h"
#include "view/server/request.h"

namespace standoff::view {
namespace {

using namespace std::chrono_literals;

class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  Client(const Client&) = delete;
  ~Client() { ::close(socket_); }

  void say(const std::string& bytes) const { ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  void say_no_more() const { ::shutdown(socket_, SHUT_WR); }
  // Until `enough` or the end.
  std::string hear(const std::function<bool(const std::string&)>& enough = {}) const {
    std::string heard;
    char part[4096];
    while (!(enough && enough(heard))) {
      const auto got = ::recv(socket_, part, sizeof part, 0);
      if (got <= 0) break;
      heard.append(part, static_cast<std::size_t>(got));
    }
    return heard;
  }
  std::string hear(const std::string& until) const {
    return hear([&](const std::string& heard) { return heard.find(until) != std::string::npos; });
  }

 private:
  int socket_;
};

// Answers "echo" with the body, "wait" once it is abandoned, "stream" with parts until it is, "throw" with an error.
class Served {
 public:
  explicit Served(ServerOptions options = {}) : server_(options, [this](auto&&... it) { answer(it...); }) {
    thread_ = std::thread([this] { server_.run([this] { return !stop_; }); });
  }
  ~Served() { stop(); }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  int port() const { return server_.port(); }
  std::string path(const std::string& route) const {
    const std::string address = server_.address();
    return address.substr(address.find('/', 7)) + route;
  }
  std::string get(const std::string& route, const std::string& more = "") const {
    return "GET " + path(route) + " HTTP/1.1\r\nHost: localhost\r\n" + more + "\r\n";
  }
  std::string post(const std::string& route, const std::string& body) const {
    return "POST " + path(route) + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(body.size()) +
           "\r\n\r\n" + body;
  }
  bool answers() const {
    const Client client(port());
    client.say(post("echo", "still here"));
    return client.hear("still here").starts_with("HTTP/1.1 200");
  }
  std::atomic<int> abandoned{0};

 private:
  void answer(const Request& request, std::string_view route, Reply& reply) {
    if (route == "echo") reply.send(200, "text/plain", request.body);
    if (route == "throw") throw Error(ErrorCode::input, "mesh: no triangles; give another");
    if (route == "stream") {
      reply.begin_stream("text/event-stream");
      while (reply.part("data: again\n\n")) std::this_thread::sleep_for(5ms);
      ++abandoned;
    }
    if (route == "wait") {
      while (!reply.abandoned()) std::this_thread::sleep_for(5ms);
      ++abandoned;
    }
  }

  std::atomic<bool> stop_{false};
  Server server_;
  std::thread thread_;
};

// A client that says so waits for the end of the connection, and waited for the server's patience.
TEST(Server, ClosesWhenTheClientAsks) {
  const Served served;
  for (const char* header : {"Connection: close\r\n", "connection: Keep-Alive , CLOSE\r\n",
                             "Connection: keep-alive\r\nConnection: close\r\n"}) {
    const Client client(served.port());
    client.say(served.get("echo", header));
    const std::string heard = client.hear();  // to the end
    EXPECT_TRUE(heard.starts_with("HTTP/1.1 200 OK\r\n")) << heard;
    EXPECT_NE(heard.find("\r\nConnection: close\r\n\r\n"), std::string::npos) << heard;
    const Client refused(served.port());
    refused.say(served.get("nothing", header));
    EXPECT_TRUE(refused.hear().starts_with("HTTP/1.1 404")) << header;
  }
  const Client other(served.port());
  other.say(served.get("echo", "Connection: keep-alive, closed\r\n") + served.post("echo", "second"));
  EXPECT_EQ(other.hear("second").find("Connection: close"), std::string::npos);
  const Client stream(served.port());
  stream.say(served.get("stream", "Connection: close\r\n"));
  const std::string heard = stream.hear("data: again\n\n");
  EXPECT_NE(heard.find("\r\nConnection: close\r\n\r\n"), std::string::npos) << heard;
}

TEST(Server, AnswersRequestsOfOneConnection) {
  const Served served;
  const Client client(served.port());
  for (const std::string body : {"one", "", "three"}) {
    client.say(served.post("echo", body));
    const std::string heard = client.hear("\r\n\r\n" + body);
    EXPECT_TRUE(heard.starts_with("HTTP/1.1 200 OK\r\n")) << heard;
    for (const char* header : {"no-store", "default-src 'none'", "nosniff", "no-referrer", "frame-ancestors 'self'"})
      EXPECT_NE(heard.find(header), std::string::npos) << header;
  }
  client.say(served.post("echo", "first") + served.post("echo", "second"));
  EXPECT_NE(client.hear("second").find("first"), std::string::npos);
  client.say(served.get("throw"));
  EXPECT_NE(client.hear("another").find("422"), std::string::npos);
  client.say(served.get("nothing"));
  EXPECT_NE(client.hear("here").find("404"), std::string::npos);
}

TEST(Server, ListensOnLoopbackAlone) {
  const Served served;
  EXPECT_NE(served.port(), 0);
  // Any other address of this machine; 127.0.0.2 is one everywhere.
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(served.port()));
  ::inet_pton(AF_INET, "127.0.0.2", &address.sin_addr);
  EXPECT_NE(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(socket);
}

TEST(Server, PortThatIsTaken) {
  const Served served;
  try {
    Server({.port = served.port()}, [](auto&&...) {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find(std::to_string(served.port())), std::string::npos);
  }
}

TEST(Server, RefusesBeforeItReadsABody) {
  const Served served({.body_bytes = 1000});
  const auto status = [&](const std::string& request) {
    const Client client(served.port());
    client.say(request);
    const std::string heard = client.hear();  // the server closes, although no body was sent
    return heard.size() > 12 ? heard.substr(9, 3) : "none";
  };
  const std::string path = served.path("echo"), lines = " HTTP/1.1\r\nHost: localhost\r\n";
  EXPECT_EQ(status("POST " + path + lines + "Content-Length: 1001\r\n\r\n"), "413");
  EXPECT_EQ(status("POST " + path + lines + "Content-Length: 18446744073709551615\r\n\r\n"), "413");
  EXPECT_EQ(status("POST " + path + lines + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n"), "501");
  EXPECT_EQ(status("POST /wrong/echo" + lines + "Content-Length: 10\r\n\r\n"), "403");
  EXPECT_EQ(status("POST " + path + " HTTP/1.1\r\nHost: evil.example\r\nContent-Length: 10\r\n\r\n"), "403");
  EXPECT_EQ(status("POST " + path + lines + "Origin: http://evil.example\r\nContent-Length: 10\r\n\r\n"), "403");
  EXPECT_EQ(status("GET " + path + lines + "Content-Length: 10\r\n\r\n"), "400");
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "HEAD", "get", "PRI"})
    EXPECT_EQ(status(method + (" " + path) + lines + "\r\n"), "405") << method;
  EXPECT_TRUE(served.answers());
}

TEST(Server, HeadsHaveALimit) {
  const Served served;
  for (const std::string& endless :
       {std::string(200'000, 'A'), "GET /" + std::string(200'000, 'a'),
        "GET / HTTP/1.1\r\nA: " + std::string(200'000, 'b'), "GET / HTTP/1.1\r\n" + std::string(200'000, '\n')}) {
    const Client client(served.port());
    client.say(endless);
    EXPECT_TRUE(client.hear().starts_with("HTTP/1.1 431"));
  }
  EXPECT_TRUE(served.answers());
}

TEST(Server, SlowClientsEnd) {
  const Served served({.head = 100ms, .stall = 100ms});
  const Client silent(served.port()), slow(served.port()), stalled(served.port());
  slow.say("GET / HT");
  stalled.say("POST " + served.path("echo") + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\nhalf");
  EXPECT_EQ(silent.hear(), "");
  EXPECT_TRUE(slow.hear().starts_with("HTTP/1.1 408"));
  EXPECT_TRUE(stalled.hear().starts_with("HTTP/1.1 408"));
  // A byte now and then does not help.
  const Client dripping(served.port());
  for (int n = 0; n < 20; ++n) {
    dripping.say("G");
    std::this_thread::sleep_for(10ms);
  }
  dripping.say_no_more();
  EXPECT_TRUE(dripping.hear().starts_with("HTTP/1.1 408"));
}

TEST(Server, StrangersDoNotCrowdOutThePage) {
  Served served({.connections = 4, .head = 60s});
  const Client page(served.port());
  page.say(served.get("stream"));
  page.hear("again");
  std::vector<std::unique_ptr<Client>> strangers;
  for (int n = 0; n < 20; ++n) {
    strangers.push_back(std::make_unique<Client>(served.port()));
    strangers.back()->say("GET / ");
  }
  EXPECT_TRUE(served.answers());
  EXPECT_NE(page.hear("again"), "");
  // Connections that have shown the token are not closed for a new one.
  std::vector<std::unique_ptr<Client>> friends;
  for (int n = 0; n < 3; ++n) {
    friends.push_back(std::make_unique<Client>(served.port()));
    friends.back()->say(served.get("stream"));
    friends.back()->hear("again");
  }
  EXPECT_EQ(Client(served.port()).hear(), "");
  EXPECT_NE(page.hear("again"), "");
}

TEST(Server, HandlersLearnThatNobodyListens) {
  Served served;
  {
    const Client stream(served.port()), wait(served.port());
    stream.say(served.get("stream"));
    EXPECT_NE(stream.hear("again").find("Transfer-Encoding: chunked"), std::string::npos);
    wait.say(served.get("wait"));
  }
  for (int n = 0; n < 1000 && served.abandoned < 2; ++n) std::this_thread::sleep_for(5ms);
  EXPECT_EQ(served.abandoned, 2);
}

TEST(Server, EndsWhateverItsClientsDo) {
  std::vector<std::unique_ptr<Client>> clients;
  {
    const Served served;
    for (const std::string& request : {served.get("stream"), served.get("wait"), std::string("GET"), std::string()}) {
      clients.push_back(std::make_unique<Client>(served.port()));
      clients.back()->say(request);
    }
    clients.front()->hear("again");
  }
  for (const auto& client : clients) client->hear();  // each sees the end
}

// Requests that are nearly right: whatever they are, the server answers the next one.
TEST(Server, MalformedRequests) {
  const Served served({.head = 200ms, .stall = 200ms});
  std::mt19937 random(1);
  const std::vector<std::string> good = {served.get("echo"), served.post("echo", "body"),
                                         served.get("echo?a=b&c=%20", "Origin: http://localhost\r\nCookie: a\r\n")};
  const std::vector<std::string> pieces = {"\r\n",
                                           "\r\n\r\n",
                                           "\n",
                                           "\0",
                                           " ",
                                           "%00",
                                           "../",
                                           "HTTP/1.1",
                                           "Content-Length: 99999\r\n",
                                           "Transfer-Encoding: chunked\r\n",
                                           "Host: evil\r\n",
                                           "\xff\xfe",
                                           ":",
                                           "?",
                                           "&",
                                           "="};
  for (int n = 0; n < 500; ++n) {
    std::string request = good[random() % good.size()];
    for (auto change = random() % 4 + 1; change > 0; --change) {
      const auto at = random() % request.size();
      switch (random() % 4) {
        case 0:
          request[at] = static_cast<char>(random());
          break;
        case 1:
          request.insert(at, pieces[random() % pieces.size()]);
          break;
        case 2:
          request.erase(at, random() % 8 + 1);
          break;
        case 3:
          request += request.substr(at);
          break;
      }
      if (request.empty()) request = " ";
    }
    const Client client(served.port());
    client.say(request);
    client.say_no_more();
    const std::string heard = client.hear();
    EXPECT_TRUE(heard.empty() || heard.starts_with("HTTP/1.1 ")) << request;
  }
  EXPECT_TRUE(served.answers());
}

TEST(PageWatch, ClosesOnceNobodyLooks) {
  PageWatch watch;
  EXPECT_FALSE(watch.closed_for(0ms));  // nobody has come yet
  {
    const PageWatch::Open first(watch);
    EXPECT_FALSE(watch.closed_for(0ms));
    { const PageWatch::Open second(watch); }
    EXPECT_FALSE(watch.closed_for(0ms));
  }
  EXPECT_TRUE(watch.closed_for(0ms));
  EXPECT_FALSE(watch.closed_for(1h));
}

// What docs/view.md says of the server's limits.
TEST(Server, TheDocumentationTellsItsLimits) {
  const std::string page = read_text(std::filesystem::path(kSourceFolder) / "docs" / "view.md");
  const ServerOptions options;
  for (const std::string& words : {"bodies of more than " + std::to_string(options.body_bytes >> 30) + " GiB",
                                   "heads of more than " + std::to_string(kMostHeadBytes >> 10) + " KiB",
                                   std::to_string(options.connections) + " connections in all",
                                   std::to_string(4 * random_token().size()) + " random bits"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
}

}  // namespace
}  // namespace standoff::view
