// SPDX-License-Identifier: Apache-2.0
#include "view/server/server.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>

#include "standoff/error.h"
#include "view/server/request.h"

extern char** environ;

namespace standoff::view {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorCode::device, what + ": " + std::strerror(errno) + "; write a page with -o instead");
}

int listen_on_loopback(int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) fail("there is no socket for the page");
  // Without it, a port that was just used stays taken for a minute.
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 && ::listen(socket, 64) == 0)
    return socket;
  const int error = errno;
  ::close(socket);
  errno = error;
  if (error == EADDRINUSE || error == EACCES)
    throw Error(ErrorCode::usage, "port " + std::to_string(port) + " cannot be had: " + std::strerror(error) +
                                      "; give another one, or 0 for any that is free");
  fail("there is no port for the page");
}

int port_of(int socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace

struct Server::State {
  // A client and the thread that answers it.
  struct Client {
    explicit Client(int fd) : socket(fd) {}
    ~Client() { ::close(socket); }
    int socket;
    std::atomic<bool> trusted{false};  // has shown the token
    std::atomic<bool> done{false};
    std::thread thread;
  };

  State(const ServerOptions& asked, Handler answer)
      : options(asked), handler(std::move(answer)), gate(random_token()), listener(listen_on_loopback(asked.port)) {}
  ~State() {
    stopping = true;
    for (auto& client : clients) ::shutdown(client.socket, SHUT_RDWR);
    for (auto& client : clients)
      if (client.thread.joinable()) client.thread.join();
    ::close(listener);
  }

  void serve(Client& client);
  bool answer(Client& client, Connection& connection);
  void accept_one();
  void remove_done();

  ServerOptions options;
  Handler handler;
  Gate gate;
  int listener;
  std::atomic<bool> stopping{false};
  std::list<Client> clients;  // oldest first; only the thread of run() touches the list
};

// One request and its answer; false where the connection is to be closed.
bool Server::State::answer(Client& client, Connection& connection) {
  Reply reply(connection, [this] { return stopping.load(); });
  const auto head = connection.read_head(client.trusted ? options.idle : options.head, options.head);
  // After a refused request, the bytes that follow may be anything.
  const auto refuse = [&](const Refusal& refusal) {
    reply.close_after();
    if (refusal.status != 0) reply.refuse(refusal);
    return false;
  };
  if (head.refusal) return refuse(*head.refusal);
  auto [request, malformed] = parse_head(head.text);
  if (malformed) return refuse(*malformed);
  if (const auto refusal = gate.check(request)) return refuse(*refusal);
  client.trusted = true;
  if (request.method != "GET" && request.method != "POST") return refuse({405, "this server knows GET and POST"});
  if (request.method == "GET" && request.body_bytes > 0) return refuse({400, "a GET with a body"});
  if (request.body_bytes > options.body_bytes)
    return refuse({413, "that is too large to be sent here; give the file to standoff view instead"});
  auto body = connection.read_body(request.body_bytes, options.stall);
  if (!body) return refuse({408, "the body did not come"});
  request.body = std::move(*body);
  if (request.closes()) reply.close_after();
  try {
    handler(request, gate.route(request), reply);
  } catch (const Error& error) {
    if (!reply.sent()) reply.refuse({422, error.what()});
  } catch (const std::exception& error) {
    if (!reply.sent()) reply.refuse({500, error.what()});
  }
  if (!reply.sent()) reply.refuse({404, "there is no such thing here"});
  reply.end_stream();
  return reply.keeps();
}

void Server::State::serve(Client& client) {
  Connection connection(client.socket);
  try {
    while (!stopping && answer(client, connection)) {
    }
  } catch (...) {
    // Memory ran out: this connection ends, the others go on.
  }
  if (!stopping) connection.finish();
  client.done = true;
}

void Server::State::remove_done() {
  clients.remove_if([](Client& client) {
    if (!client.done) return false;
    client.thread.join();
    return true;
  });
}

void Server::State::accept_one() {
  const int socket = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (socket < 0) return;
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  remove_done();
  if (clients.size() >= static_cast<std::size_t>(options.connections)) {
    const auto oldest = std::ranges::find_if(clients, [](const Client& client) { return !client.trusted; });
    if (oldest == clients.end()) {
      ::close(socket);
      return;
    }
    ::shutdown(oldest->socket, SHUT_RDWR);
    oldest->thread.join();  // it does nothing but read and refuse, which the shutdown ends
    clients.erase(oldest);
  }
  Client& client = clients.emplace_back(socket);
  try {
    client.thread = std::thread([this, &client] { serve(client); });
  } catch (const std::system_error&) {
    clients.pop_back();  // no more threads: as if it were one connection too many
  }
}

Server::Server(const ServerOptions& options, Handler handler)
    : state_(std::make_unique<State>(options, std::move(handler))) {}
Server::~Server() = default;

int Server::port() const { return port_of(state_->listener); }

std::string Server::address() const {
  return "http://127.0.0.1:" + std::to_string(port()) + '/' + state_->gate.token() + '/';
}

void Server::run(const std::function<bool()>& go_on) {
  while (go_on()) {
    pollfd asked{state_->listener, POLLIN, 0};
    if (::poll(&asked, 1, 50) > 0) state_->accept_one();
    state_->remove_done();
  }
}

namespace {

#ifdef __APPLE__
constexpr const char* kProgram = "open";
#else
constexpr const char* kProgram = "xdg-open";
#endif

}  // namespace

std::string signpost(const std::string& address) {
  return "<!doctype html><meta charset=utf-8><title>standoff</title><meta http-equiv=refresh content=\"0;url=" +
         address + "\"><a href=\"" + address + "\">the page of standoff</a>\n";
}

bool has_screen() {
#ifdef __APPLE__
  return std::getenv("SSH_CONNECTION") == nullptr;
#else
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(name); value && *value) return true;
  return false;
#endif
}

bool open_browser(const std::filesystem::path& file) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  if (::posix_spawn_file_actions_init(&actions) != 0) return false;
  if (::posix_spawnattr_init(&attributes) != 0) {
    ::posix_spawn_file_actions_destroy(&actions);
    return false;
  }
  // What a browser says is not for this terminal.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  // A process group of its own: Ctrl-C here is not meant for the browser.
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::string path = file.string(), name = kProgram;
  char* arguments[] = {name.data(), path.data(), nullptr};
  pid_t child = 0;
  const bool started = ::posix_spawnp(&child, kProgram, &actions, &attributes, arguments, environ) == 0;
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  return started;
}

}  // namespace standoff::view
