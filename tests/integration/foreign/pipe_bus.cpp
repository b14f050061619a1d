#include "tests/integration/foreign/pipe_bus.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace patella::test {
namespace {

constexpr std::size_t kMostFrames = 1U << 18U;
constexpr std::array<char, 17> kDigits{"0123456789ABCDEF"};

std::string lineOf(const can::Frame& frame) {
  std::string line;
  for (int shift = 8; shift >= 0; shift -= 4) {
    line += kDigits[frame.id >> static_cast<unsigned>(shift) & 0xFU];
  }
  line += '#';
  for (std::size_t i = 0; i < frame.length; ++i) {
    line += kDigits[frame.data[i] >> 4U];
    line += kDigits[frame.data[i] & 0xFU];
  }
  return line + "\n";
}

can::Frame frameOf(const std::string& line) {
  const std::size_t mark = line.find('#');
  can::Frame frame;
  frame.id = static_cast<std::uint32_t>(std::strtoul(line.substr(0, mark).c_str(), nullptr, 16));
  for (std::size_t at = mark + 1; at + 1 < line.size() && frame.length < 8; at += 2) {
    frame.data[frame.length++] =
        static_cast<std::uint8_t>(std::strtoul(line.substr(at, 2).c_str(), nullptr, 16));
  }
  return frame;
}

}  // namespace

PipeBus::PipeBus(const std::vector<std::string>& command, const can::Database& database)
    : operator_(database, "Operator", {"Enable", "Reset"}) {
  std::array<int, 2> in{}, out{};
  if (pipe2(in.data(), O_CLOEXEC) != 0 || pipe2(out.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe to be had");
  }
  std::vector<char*> arguments;
  for (const std::string& argument : command) {
    arguments.push_back(const_cast<char*>(argument.c_str()));
  }
  arguments.push_back(nullptr);
  log_.reserve(kMostFrames);
  std::signal(SIGPIPE, SIG_IGN);
  child_ = fork();
  if (child_ == 0) {
    dup2(in[0], STDIN_FILENO);
    dup2(out[1], STDOUT_FILENO);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  ::close(in[0]);
  ::close(out[1]);
  to_ = in[1];
  from_ = out[0];
  fcntl(from_, F_SETFL, O_NONBLOCK);
}

PipeBus::~PipeBus() {
  close();
  ::close(from_);
}

int PipeBus::close() noexcept {
  if (child_ <= 0) {
    return -1;
  }
  ::close(to_);
  int status = 0;
  waitpid(std::exchange(child_, -1), &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::size_t PipeBus::receive(std::span<can::Frame> frames, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  std::array<char, 4096> bytes;
  for (ssize_t got = 0; (got = read(from_, bytes.data(), bytes.size())) > 0;) {
    rest_.append(bytes.data(), static_cast<std::size_t>(got));
  }
  std::size_t count = 0;
  const auto take = [&](const can::Frame& frame) {
    frames[count] = frame;
    frames[count].monotonic_ns = frames[count].wall_ns = now_ns;
    note(frames[count++]);
  };
  for (std::size_t end = rest_.find('\n'); end != std::string::npos && count + 1 < frames.size();
       end = rest_.find('\n')) {
    take(frameOf(rest_.substr(0, end)));
    rest_.erase(0, end + 1);
  }
  if (operated_) {
    take(operator_.make({enable_ ? 1.0 : 0.0, 0.0}));
  }
  return count;
}

can::SendResult PipeBus::send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  frame.monotonic_ns = frame.wall_ns = now_ns;
  const std::string line = lineOf(frame);
  if (write(to_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    return can::SendResult::kDown;
  }
  note(frame);
  return can::SendResult::kSent;
}

void PipeBus::note(const can::Frame& frame) noexcept {
  if (log_.size() < kMostFrames) {
    log_.push_back(frame);
  }
}

}  // namespace patella::test
