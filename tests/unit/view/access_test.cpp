#include "tools/view/access.hpp"

#include <stdexcept>

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella::view;

TEST_CASE("a token lets in who gives it, and nobody else") {
  const Access access{.token = "correct-horse-battery", .hosts = {}, .origins = {}};
  const auto visit = [&](const char* target) {
    return refusal(access, {.host = "rig:8765", .origin = "", .target = target});
  };
  CHECK(visit("/?token=correct-horse-battery").empty());
  CHECK(visit("/recording?a=b&token=correct-horse-battery").empty());
  for (const char* target :
       {"/", "/?token=", "/?token=correct-horse-batterx", "/?token=correct-horse-battery1",
        "/?tokens=correct-horse-battery", "/token=correct-horse-battery"}) {
    CAPTURE(target);
    CHECK(visit(target).find("token") != std::string::npos);
  }
}

TEST_CASE("pages of other sites and names that were made to lead here are refused") {
  const Access access{
      .token = "", .hosts = hostsOf("127.0.0.1", 8765), .origins = {"https://app.foxglove.dev"}};
  const auto visit = [&](const char* host, const char* origin) {
    return refusal(access, {.host = host, .origin = origin, .target = "/"});
  };
  CHECK(visit("127.0.0.1:8765", "").empty());
  CHECK(visit("localhost:8765", "http://localhost:8765").empty());
  CHECK(visit("127.0.0.1:8765", "https://app.foxglove.dev").empty());
  CHECK_FALSE(visit("127.0.0.1:8765", "https://elsewhere.example").empty());
  CHECK_FALSE(visit("127.0.0.1:8765", "null").empty());
  CHECK_FALSE(visit("elsewhere.example:8765", "").empty());
  CHECK_FALSE(visit("127.0.0.1:80", "").empty());
}

TEST_CASE("on port 80, which browsers leave out, names come in with the port and without") {
  const Access access{.token = "", .hosts = hostsOf("192.168.7.2", 80), .origins = {}};
  const auto visit = [&](const char* host, const char* origin) {
    return refusal(access, {.host = host, .origin = origin, .target = "/"});
  };
  for (const char* host : {"192.168.7.2", "192.168.7.2:80", "localhost", "127.0.0.1", "[::1]", "[::1]:80"}) {
    CAPTURE(host);
    CHECK(visit(host, "").empty());
  }
  CHECK(visit("localhost", "http://localhost").empty());
  CHECK_FALSE(visit("localhost", "http://elsewhere.example").empty());
  CHECK_FALSE(visit("elsewhere.example", "").empty());
  const Access other{.token = "", .hosts = hostsOf("127.0.0.1", 8765), .origins = {}};
  CHECK_FALSE(refusal(other, {.host = "127.0.0.1", .origin = "", .target = "/"}).empty());
}

TEST_CASE("a token is the first word of its file; one that cannot be read says why") {
  const patella::test::ScratchFolder folder;
  const auto refused = [](const std::filesystem::path& file) {
    return patella::test::messageOf<std::runtime_error>([&] { readToken(file); });
  };
  const std::filesystem::path file = folder / "token";
  patella::app::writeFile(file, "\n  correct-horse-battery\nwhat else stands there\n");
  CHECK(readToken(file) == "correct-horse-battery");
  patella::app::writeFile(file, "horse\n");
  CHECK(refused(file) == file.string() + ": a token of 5 characters, expected at least 16");
  patella::app::writeFile(file, "");
  CHECK(refused(file) == file.string() + ": a token of 0 characters, expected at least 16");
  // The kernel refuses to read it, whoever asks.
  CHECK(refused("/proc/self/mem") == "/proc/self/mem: cannot be read: Input/output error");
  CHECK(refused(folder.path()) == folder.path().string() + ": is a directory, expected a regular file");
}
