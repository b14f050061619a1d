// host_call write NAME < DATA     writes a file into QEMU's working folder
// host_call await NAME            waits until the host has left a file there, and removes it
// host_call exit STATUS           writes the file "status" there and ends the machine
//
// The board's way out, by Arm semihosting (https://github.com/ARM-software/abi-aa, "Semihosting for AArch32
// and AArch64"): the processor traps into QEMU, without a device, a driver or an interrupt that would disturb
// the run.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>

#include <unistd.h>

namespace {

constexpr std::uintptr_t kOpen = 0x01;
constexpr std::uintptr_t kClose = 0x02;
constexpr std::uintptr_t kWrite = 0x05;
constexpr std::uintptr_t kRemove = 0x0E;
constexpr std::uintptr_t kExit = 0x18;
constexpr std::uintptr_t kReadBinary = 1;             // fopen's "rb"
constexpr std::uintptr_t kWriteBinary = 5;            // fopen's "wb"
constexpr std::uintptr_t kApplicationExit = 0x20026;  // ADP_Stopped_ApplicationExit

// The host reads memory that the processor has mapped: everything passed here has been written to before.
std::intptr_t trap(std::uintptr_t operation, const std::uintptr_t* block) {
  register std::uintptr_t x0 asm("x0") = operation;
  register const std::uintptr_t* x1 asm("x1") = block;
  asm volatile("hlt #0xf000" : "+r"(x0) : "r"(x1) : "memory");
  return static_cast<std::intptr_t>(x0);
}

std::uintptr_t address(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}

class HostFile {
 public:
  HostFile(const char* name, std::uintptr_t mode) {
    const std::array<std::uintptr_t, 3> block{address(name), mode, std::strlen(name)};
    handle_ = trap(kOpen, block.data());
  }
  ~HostFile() {
    if (!isOpen()) {
      return;
    }
    const std::array<std::uintptr_t, 1> block{static_cast<std::uintptr_t>(handle_)};
    trap(kClose, block.data());
  }
  HostFile(const HostFile&) = delete;
  HostFile& operator=(const HostFile&) = delete;

  bool isOpen() const { return handle_ >= 0; }

  bool write(const char* data, std::size_t size) const {
    const std::array<std::uintptr_t, 3> block{static_cast<std::uintptr_t>(handle_), address(data), size};
    return isOpen() && trap(kWrite, block.data()) == 0;  // the number of bytes not written
  }

 private:
  std::intptr_t handle_ = -1;
};

bool copyInput(const char* name) {
  static std::array<char, 65536> buffer;
  const HostFile file(name, kWriteBinary);
  ssize_t got = 0;
  while ((got = read(STDIN_FILENO, buffer.data(), buffer.size())) > 0) {
    if (!file.write(buffer.data(), static_cast<std::size_t>(got))) {
      return false;
    }
  }
  return got == 0;
}

// Hardly any of the board's time passes meanwhile: a processor that traps executes next to nothing.
void await(const char* name) {
  while (!HostFile(name, kReadBinary).isOpen()) {
  }
  const std::array<std::uintptr_t, 2> block{address(name), std::strlen(name)};
  trap(kRemove, block.data());
}

}  // namespace

int main(int count, char** arguments) {
  const std::string_view verb = count == 3 ? arguments[1] : "";
  if (verb == "write") {
    if (copyInput(arguments[2])) {
      return 0;
    }
    std::fprintf(stderr, "host_call: cannot write %s\n", arguments[2]);
    return 1;
  }
  if (verb == "await") {
    await(arguments[2]);
    return 0;
  }
  if (verb == "exit") {
    {
      const HostFile status("status", kWriteBinary);
      status.write(arguments[2], std::strlen(arguments[2]));
    }
    const std::array<std::uintptr_t, 2> block{kApplicationExit, 0};
    trap(kExit, block.data());
  }
  std::fputs("usage: host_call write NAME | await NAME | exit STATUS\n", stderr);
  return 2;
}
