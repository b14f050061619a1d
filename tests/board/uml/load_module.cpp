// load_module FILE...: loads kernel modules in the order given, so that the guest needs no kmod package.
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) {
    const int file = open(arguments[i], O_RDONLY | O_CLOEXEC);
    if (file < 0 || (syscall(SYS_finit_module, file, "", 0) != 0 && errno != EEXIST)) {
      std::fprintf(stderr, "load_module: %s: %s\n", arguments[i], std::strerror(errno));
      return 1;
    }
    close(file);
  }
  return 0;
}
